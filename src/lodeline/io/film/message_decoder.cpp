#include <fmt/core.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/film/av_handles.h"
#include "lodeline/io/film/film_decoder.h"
#include "lodeline/io/film/grey_frame.h"

namespace lodeline {

struct MessageDecoder::State {
  av::Codec codec;
  av::Packet packet{av_packet_alloc()};
  av::Frame frame{av_frame_alloc()};
};

MessageDecoder::MessageDecoder(const std::string& codec) : state_(std::make_unique<State>()) {
  av_log_set_level(AV_LOG_QUIET);
  const AVCodec* known = avcodec_find_decoder_by_name(codec.c_str());
  if (known == nullptr) throw InputError(fmt::format("no decoder for '{}' is installed", codec));
  state_->codec.reset(avcodec_alloc_context3(known));
  // Each message gives its image at once: no threads that hold images back.
  state_->codec->thread_count = 1;
  state_->codec->flags |= AV_CODEC_FLAG_LOW_DELAY;
  if (const int result = avcodec_open2(state_->codec.get(), known, nullptr); result < 0) {
    throw InputError(fmt::format("codec '{}': {}", codec, av::errorText(result)));
  }
}

MessageDecoder::~MessageDecoder() = default;

LoadedImage MessageDecoder::decode(std::span<const uint8_t> message) {
  AVPacket* const packet = state_->packet.get();
  av_packet_unref(packet);
  if (message.empty()) return {cv::Mat(), "holds no image"};
  if (av_new_packet(packet, static_cast<int>(message.size())) < 0) return {cv::Mat(), "out of memory"};
  std::copy(message.begin(), message.end(), packet->data);
  if (const int sent = avcodec_send_packet(state_->codec.get(), packet); sent < 0) {
    return {cv::Mat(), "cannot be decoded: " + av::errorText(sent)};
  }
  cv::Mat grey;
  AVFrame* const frame = state_->frame.get();
  while (avcodec_receive_frame(state_->codec.get(), frame) == 0) {
    const bool is_damaged = frame->decode_error_flags != 0 || (frame->flags & AV_FRAME_FLAG_CORRUPT) != 0;
    if (!is_damaged) grey = av::greyFrame(*frame, {});
  }
  if (grey.empty()) return {cv::Mat(), "gives no image: it depends on a key frame that is not before it"};
  return {grey, ""};
}

void MessageDecoder::restart() { avcodec_flush_buffers(state_->codec.get()); }

}  // namespace lodeline
