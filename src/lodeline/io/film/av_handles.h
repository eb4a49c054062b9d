#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/frame.h>
#include <libswscale/swscale.h>
}

#include <filesystem>
#include <memory>
#include <string>

#include "lodeline/types.h"

/// Owners of the objects of FFmpeg's libraries, and their times as Duration.
namespace lodeline::av {

struct CloseInput {
  void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
};
struct FreePacket {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
struct FreeFrame {
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
struct FreeCodec {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
};
using Input = std::unique_ptr<AVFormatContext, CloseInput>;
using Packet = std::unique_ptr<AVPacket, FreePacket>;
using Frame = std::unique_ptr<AVFrame, FreeFrame>;
using Codec = std::unique_ptr<AVCodecContext, FreeCodec>;

/// Opens a file and reads its headers. Throws InputError.
Input openInput(const std::filesystem::path& file);

/// Makes all other tracks of an open file unread.
void readOnly(AVFormatContext* input, int track);

std::string errorText(int code);

inline constexpr AVRational kNanoseconds = {1, 1'000'000'000};
inline Duration duration(int64_t ticks, AVRational unit) {
  return Duration::fromNanoseconds(av_rescale_q(ticks, unit, kNanoseconds));
}

}  // namespace lodeline::av
