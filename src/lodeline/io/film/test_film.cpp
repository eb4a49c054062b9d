#include "lodeline/io/film/test_film.h"

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "lodeline/io/film/av_handles.h"

extern "C" {
#include <libavutil/display.h>
#include <libavutil/opt.h>
}

// What the leak sanitizer passes over: the encoder libx265 of Debian 12 does not free all that it allocates.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libx265\n"; }

namespace lodeline::test {
namespace {

constexpr AVRational kMilliseconds = {1, 1000};

int check(int result, const char* what) {
  if (result < 0) throw std::runtime_error(std::string(what) + ": " + av::errorText(result));
  return result;
}

struct FreeOutput {
  void operator()(AVFormatContext* context) const {
    if (context->pb != nullptr) avio_closep(&context->pb);
    avformat_free_context(context);
  }
};

class FilmWriter {
 public:
  FilmWriter(const std::filesystem::path& file, const TestFilm& film) : film_(film) {
    AVFormatContext* context = nullptr;
    check(avformat_alloc_output_context2(&context, nullptr, nullptr, file.c_str()), "container");
    output_.reset(context);
    openCodec();
    addTracks();
    check(avio_open(&output_->pb, file.c_str(), AVIO_FLAG_WRITE), "file");
    AVDictionary* options = nullptr;
    if (film.index_first) av_dict_set(&options, "movflags", "faststart", 0);
    output_->avoid_negative_ts = 0;
    check(avformat_write_header(output_.get(), &options), "header");
    av_dict_free(&options);
  }

  void write() {
    size_t payload = 0;
    for (int i = 0; i < film_.images; ++i) {
      const double time_s = film_.images_start_s + static_cast<double>(i) / film_.images_per_s;
      while (payload < film_.telemetry.size() && film_.telemetry[payload].time_s <= time_s) {
        writePayload(film_.telemetry[payload++]);
      }
      encode(i);
    }
    while (payload < film_.telemetry.size()) writePayload(film_.telemetry[payload++]);
    send(nullptr);
    check(av_write_trailer(output_.get()), "trailer");
  }

 private:
  void openCodec() {
    const AVCodec* codec = avcodec_find_encoder_by_name(film_.codec.c_str());
    if (codec == nullptr) throw std::runtime_error("no encoder " + film_.codec);
    codec_.reset(avcodec_alloc_context3(codec));
    codec_->width = film_.width_px;
    codec_->height = film_.height_px;
    codec_->pix_fmt = codec->pix_fmts[0];
    codec_->time_base = {1, film_.images_per_s};
    codec_->framerate = {film_.images_per_s, 1};
    codec_->gop_size = film_.key_step;
    codec_->max_b_frames = film_.reordered;
    codec_->bit_rate = 4'000'000;
    codec_->thread_count = 1;
    if ((output_->oformat->flags & AVFMT_GLOBALHEADER) != 0) codec_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    check(avcodec_open2(codec_.get(), codec, nullptr), "codec");
  }

  void addTracks() {
    images_ = avformat_new_stream(output_.get(), nullptr);
    avcodec_parameters_from_context(images_->codecpar, codec_.get());
    images_->time_base = codec_->time_base;
    images_->avg_frame_rate = codec_->framerate;
    if (film_.turned_deg != 0.0) {
      auto* matrix = reinterpret_cast<int32_t*>(
          av_stream_new_side_data(images_, AV_PKT_DATA_DISPLAYMATRIX, 9 * sizeof(int32_t)));
      av_display_rotation_set(matrix, film_.turned_deg);
    }
    if (film_.telemetry.empty()) return;
    telemetry_ = avformat_new_stream(output_.get(), nullptr);
    telemetry_->codecpar->codec_type = AVMEDIA_TYPE_DATA;
    telemetry_->codecpar->codec_id = AV_CODEC_ID_BIN_DATA;
    telemetry_->codecpar->codec_tag = MKTAG('g', 'p', 'm', 'd');
    telemetry_->time_base = kMilliseconds;
  }

  void encode(int number) {
    av::Frame frame(av_frame_alloc());
    frame->width = film_.width_px;
    frame->height = film_.height_px;
    frame->format = codec_->pix_fmt;
    check(av_frame_get_buffer(frame.get(), 0), "frame");
    for (int plane = 0; plane < 3 && frame->data[plane] != nullptr; ++plane) {
      const int rows = plane == 0 ? frame->height : (frame->height + 1) / 2;
      std::memset(frame->data[plane], plane == 0 ? greyOfImage(number) : 128,
                  static_cast<size_t>(frame->linesize[plane] * rows));
    }
    frame->pts = std::llround(film_.images_start_s * film_.images_per_s) + number;
    send(frame.get());
  }

  void send(const AVFrame* frame) {
    check(avcodec_send_frame(codec_.get(), frame), "encoding");
    av::Packet packet(av_packet_alloc());
    while (avcodec_receive_packet(codec_.get(), packet.get()) == 0) {
      packet->duration = 1;
      write(packet.get(), images_, codec_->time_base);
    }
  }

  void writePayload(const FilmPayload& payload) {
    av::Packet packet(av_packet_alloc());
    check(av_new_packet(packet.get(), static_cast<int>(payload.bytes.size())), "payload");
    if (!payload.bytes.empty()) std::memcpy(packet->data, payload.bytes.data(), payload.bytes.size());
    packet->pts = packet->dts = std::llround(payload.time_s * 1000.0);
    packet->duration = std::llround(payload.length_s * 1000.0);
    packet->flags |= AV_PKT_FLAG_KEY;
    write(packet.get(), telemetry_, kMilliseconds);
  }

  void write(AVPacket* packet, AVStream* stream, AVRational unit) {
    packet->stream_index = stream->index;
    av_packet_rescale_ts(packet, unit, stream->time_base);
    check(av_interleaved_write_frame(output_.get(), packet), "packet");
  }

  TestFilm film_;
  std::unique_ptr<AVFormatContext, FreeOutput> output_;
  av::Codec codec_;
  AVStream* images_ = nullptr;
  AVStream* telemetry_ = nullptr;
};

}  // namespace

void writeFilm(const std::filesystem::path& file, const TestFilm& film) { FilmWriter(file, film).write(); }

}  // namespace lodeline::test
