#include "lodeline/io/film/film_reader.h"

#include <fmt/core.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/io/film/av_handles.h"

extern "C" {
#include <libavutil/display.h>
}

namespace lodeline {
namespace {

FilmTrack::Kind kindOf(const AVStream& stream) {
  if (stream.codecpar->codec_type == AVMEDIA_TYPE_VIDEO) {
    const bool is_cover = (stream.disposition & AV_DISPOSITION_ATTACHED_PIC) != 0;
    return is_cover ? FilmTrack::Kind::Other : FilmTrack::Kind::Images;
  }
  if (stream.codecpar->codec_tag == MKTAG('g', 'p', 'm', 'd')) return FilmTrack::Kind::Telemetry;
  return FilmTrack::Kind::Other;
}

double turnedBy_deg(const AVStream& stream) {
  const uint8_t* matrix = av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr);
  if (matrix == nullptr) return 0.0;
  return -av_display_rotation_get(reinterpret_cast<const int32_t*>(matrix));
}

FilmTrack trackOf(const AVStream& stream) {
  FilmTrack track;
  track.index = stream.index;
  track.kind = kindOf(stream);
  track.codec = avcodec_get_name(stream.codecpar->codec_id);
  char tag[AV_FOURCC_MAX_STRING_SIZE] = {};
  track.tag = av_fourcc_make_string(tag, stream.codecpar->codec_tag);
  track.stated_count = stream.nb_frames;
  if (stream.start_time != AV_NOPTS_VALUE) track.start = av::duration(stream.start_time, stream.time_base);
  if (stream.duration != AV_NOPTS_VALUE) track.length = av::duration(stream.duration, stream.time_base);
  if (track.kind != FilmTrack::Kind::Images) return track;
  track.width_px = stream.codecpar->width;
  track.height_px = stream.codecpar->height;
  track.turned_deg = turnedBy_deg(stream);
  if (stream.avg_frame_rate.den > 0) track.rate_hz = av_q2d(stream.avg_frame_rate);
  return track;
}

}  // namespace

bool canReadFilms() { return true; }

const FilmTrack* FilmInfo::first(FilmTrack::Kind kind) const {
  const auto found =
      std::find_if(tracks.begin(), tracks.end(), [&](const FilmTrack& track) { return track.kind == kind; });
  return found == tracks.end() ? nullptr : &*found;
}

FilmInfo describeFilm(const std::filesystem::path& file) {
  const av::Input input = av::openInput(file);
  FilmInfo info;
  for (unsigned i = 0; i < input->nb_streams; ++i) info.tracks.push_back(trackOf(*input->streams[i]));
  const AVDictionaryEntry* entry = nullptr;
  while ((entry = av_dict_get(input->metadata, "", entry, AV_DICT_IGNORE_SUFFIX)) != nullptr) {
    info.tags[entry->key] = entry->value;
  }
  return info;
}

struct FilmTrackReader::Demuxer {
  av::Input input;
  av::Packet packet{av_packet_alloc()};
  AVRational unit{};
};

FilmTrackReader::FilmTrackReader(const std::filesystem::path& file, int track)
    : demuxer_(std::make_unique<Demuxer>()) {
  demuxer_->input = av::openInput(file);
  if (track < 0 || track >= static_cast<int>(demuxer_->input->nb_streams)) {
    throw InputError(fmt::format("{}: has no track {}", file.string(), track));
  }
  av::readOnly(demuxer_->input.get(), track);
  demuxer_->unit = demuxer_->input->streams[track]->time_base;
}

FilmTrackReader::~FilmTrackReader() = default;
FilmTrackReader::FilmTrackReader(FilmTrackReader&&) noexcept = default;
FilmTrackReader& FilmTrackReader::operator=(FilmTrackReader&&) noexcept = default;

bool FilmTrackReader::advance(FilmPacket* packet, std::optional<Duration>* decode_time, bool with_bytes) {
  AVPacket* const read = demuxer_->packet.get();
  while (true) {
    av_packet_unref(read);
    if (av_read_frame(demuxer_->input.get(), read) < 0) return false;
    if (demuxer_->input->streams[read->stream_index]->discard == AVDISCARD_ALL) continue;
    ++packets_;
    const int64_t ticks = read->pts != AV_NOPTS_VALUE ? read->pts : read->dts;
    if (ticks == AV_NOPTS_VALUE) continue;
    packet->time = av::duration(ticks, demuxer_->unit);
    packet->length = av::duration(std::max<int64_t>(read->duration, 0), demuxer_->unit);
    packet->shown = (read->flags & AV_PKT_FLAG_DISCARD) == 0;
    decode_time->reset();
    if (read->dts != AV_NOPTS_VALUE) *decode_time = av::duration(read->dts, demuxer_->unit);
    if (with_bytes) packet->bytes.assign(read->data, read->data + read->size);
    return true;
  }
}

std::optional<FilmPacket> FilmTrackReader::next() {
  FilmPacket packet;
  std::optional<Duration> ignored;
  if (!advance(&packet, &ignored, true)) return std::nullopt;
  return packet;
}

FilmFrameTimes::FilmFrameTimes(const std::filesystem::path& file, int track) : reader_(file, track) {}

std::optional<Duration> FilmFrameTimes::next() {
  constexpr size_t kGreatestReordering = 64;
  const auto isLater = [](Duration a, Duration b) { return a > b; };
  while (true) {
    const bool is_settled = settled_ && !waiting_.empty() && waiting_.front() <= *settled_;
    if (!waiting_.empty() && (ended_ || is_settled || waiting_.size() > kGreatestReordering)) {
      std::pop_heap(waiting_.begin(), waiting_.end(), isLater);
      const Duration first = waiting_.back();
      waiting_.pop_back();
      return first;
    }
    if (ended_) return std::nullopt;
    FilmPacket packet;
    std::optional<Duration> decode_time;
    if (!reader_.advance(&packet, &decode_time, false)) {
      ended_ = true;
      continue;
    }
    if (decode_time) settled_ = decode_time;
    if (!packet.shown) continue;
    waiting_.push_back(packet.time);
    std::push_heap(waiting_.begin(), waiting_.end(), isLater);
  }
}

}  // namespace lodeline
