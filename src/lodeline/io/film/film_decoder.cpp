#include "lodeline/io/film/film_decoder.h"

#include <fmt/core.h>

#include <algorithm>
#include <deque>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

#include "lodeline/diagnostics.h"
#include "lodeline/io/film/av_handles.h"
#include "lodeline/io/film/grey_frame.h"

namespace lodeline {
namespace {

constexpr unsigned kMostThreads = 4;
/// Ahead of the decoder by more than this, a seek to a key image costs less than decoding all images between.
/// For files without an index of their images.
constexpr double kFarAhead_s = 10.0;
/// The same by the index: images before the key image, more than the codec works on at a time.
constexpr int kMostBeforeKey = 16;
constexpr size_t kMostKept = 8;

}  // namespace

struct FilmDecoder::State {
  /// A decoded image that waits for its load().
  struct Kept {
    Duration time;
    av::Frame frame;
  };
  struct Loaded {
    Duration time;
    LoadedImage image;
  };

  mutable std::mutex mutex;
  std::string name;
  cv::Size size;
  av::Input input;
  int track = 0;
  AVRational unit{};
  av::Codec codec;
  av::Packet packet{av_packet_alloc()};
  std::optional<Duration> position;  ///< time of the last decoded image
  bool ended = false;                ///< all packets were given to the codec
  std::set<int64_t> announced_ns;
  std::deque<Kept> kept;
  std::optional<Loaded> last;
  int64_t decoded = 0;

  void open(const std::filesystem::path& file);
  void seek(Duration time);
  av::Frame next();
  av::Frame decodeUpTo(Duration time);
  av::Frame takeKept(Duration time);
  int64_t ticks(Duration time) const { return av_rescale_q(time.nanoseconds(), av::kNanoseconds, unit); }
  int indexAt(Duration time, bool only_keys) const;
  bool needsSeek(Duration time) const;
  av::Frame find(Duration time);
  LoadedImage imageOf(const av::Frame& frame, Duration time) const;
  Duration timeOf(const AVFrame& frame) const { return av::duration(frame.best_effort_timestamp, unit); }
};

void FilmDecoder::State::open(const std::filesystem::path& file) {
  name = file.string();
  input = av::openInput(file);
  av::readOnly(input.get(), track);
  const AVStream& stream = *input->streams[track];
  unit = stream.time_base;
  const AVCodec* known = avcodec_find_decoder(stream.codecpar->codec_id);
  if (known == nullptr) {
    throw InputError(fmt::format("{}: no decoder for its codec '{}' is installed", name,
                                 avcodec_get_name(stream.codecpar->codec_id)));
  }
  codec.reset(avcodec_alloc_context3(known));
  avcodec_parameters_to_context(codec.get(), stream.codecpar);
  codec->pkt_timebase = unit;
  codec->thread_count = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, kMostThreads));
  if (const int result = avcodec_open2(codec.get(), known, nullptr); result < 0) {
    throw InputError(fmt::format("{}: codec '{}': {}", name, known->name, av::errorText(result)));
  }
}

/// Number in the index of the last image that is decoded at `time` or before, of all or of key images. The
/// times of an index are those of decoding: an image is shown at its time or later. -1 without an index.
int FilmDecoder::State::indexAt(Duration time, bool only_keys) const {
  const int flags = AVSEEK_FLAG_BACKWARD | (only_keys ? 0 : AVSEEK_FLAG_ANY);
  return av_index_search_timestamp(input->streams[track], ticks(time), flags);
}

void FilmDecoder::State::seek(Duration time) {
  const int64_t latest = ticks(time);
  if (avformat_seek_file(input.get(), track, INT64_MIN, latest, latest, 0) < 0) {
    av_seek_frame(input.get(), track, INT64_MIN, AVSEEK_FLAG_BACKWARD);
  }
  avcodec_flush_buffers(codec.get());
  position.reset();
  ended = false;
}

av::Frame FilmDecoder::State::next() {
  av::Frame frame(av_frame_alloc());
  while (true) {
    const int received = avcodec_receive_frame(codec.get(), frame.get());
    if (received == 0) {
      ++decoded;
      if (frame->best_effort_timestamp == AV_NOPTS_VALUE) continue;
      return frame;
    }
    if (received != AVERROR(EAGAIN)) {
      if (received == AVERROR_EOF || ended) return nullptr;
      continue;  // one damaged image
    }
    av_packet_unref(packet.get());
    if (av_read_frame(input.get(), packet.get()) < 0) {
      ended = true;
      avcodec_send_packet(codec.get(), nullptr);
    } else if (packet->stream_index == track) {
      avcodec_send_packet(codec.get(), packet.get());
    }
  }
}

av::Frame FilmDecoder::State::takeKept(Duration time) {
  const auto found = std::find_if(kept.begin(), kept.end(), [&](const Kept& k) { return k.time == time; });
  if (found == kept.end()) return nullptr;
  av::Frame frame = std::move(found->frame);
  kept.erase(found);
  return frame;
}

av::Frame FilmDecoder::State::decodeUpTo(Duration time) {
  while (av::Frame frame = next()) {
    const Duration reached = timeOf(*frame);
    position = reached;
    if (reached == time) return frame;
    if (announced_ns.contains(reached.nanoseconds())) {
      if (kept.size() == kMostKept) kept.pop_front();
      kept.push_back({reached, std::move(frame)});
    }
    if (reached > time) return nullptr;
  }
  return nullptr;
}

bool FilmDecoder::State::needsSeek(Duration time) const {
  if (position && *position >= time) return true;
  const Duration reached = position.value_or(Duration());
  if ((time - reached).seconds() > kFarAhead_s) return true;
  return indexAt(time, true) - std::max(0, indexAt(reached, false)) > kMostBeforeKey;
}

av::Frame FilmDecoder::State::find(Duration time) {
  if (av::Frame frame = takeKept(time)) return frame;
  const bool is_sought = needsSeek(time);
  if (is_sought) seek(time);
  av::Frame frame = decodeUpTo(time);
  const bool is_past = position ? *position > time : is_sought;
  if (frame || !is_past) return frame;
  // The index led to a key image that is shown after the image, or to the end: once more from the key image
  // before, and from the start of the film.
  if (const int key = indexAt(time, true); key > 0) {
    const AVIndexEntry* entry = avformat_index_get_entry(input->streams[track], key - 1);
    seek(av::duration(entry->timestamp, unit));
    frame = decodeUpTo(time);
  }
  if (frame) return frame;
  seek(Duration::fromSeconds(-1e6));
  return decodeUpTo(time);
}

LoadedImage FilmDecoder::State::imageOf(const av::Frame& frame, Duration time) const {
  const std::string where = fmt::format("{} at {:.3f} s", name, time.seconds());
  if (!frame) return {cv::Mat(), where + ": the image cannot be decoded"};
  if (frame->decode_error_flags != 0 || (frame->flags & AV_FRAME_FLAG_CORRUPT) != 0) {
    return {cv::Mat(), where + ": the image is damaged"};
  }
  cv::Mat grey = av::greyFrame(*frame, size);
  if (grey.empty()) return {cv::Mat(), where + ": its pixel format cannot be converted to grey"};
  return {grey, ""};
}

FilmDecoder::FilmDecoder(const std::filesystem::path& file, int track, cv::Size size)
    : state_(std::make_unique<State>()) {
  state_->track = track;
  state_->size = size;
  state_->open(file);
}

FilmDecoder::~FilmDecoder() = default;

void FilmDecoder::announce(Duration time) {
  const std::lock_guard lock(state_->mutex);
  state_->announced_ns.insert(time.nanoseconds());
}

LoadedImage FilmDecoder::load(Duration time) {
  av::Frame frame;
  {
    const std::lock_guard lock(state_->mutex);
    if (state_->last && state_->last->time == time) return state_->last->image;
    // What is announced before this image by more than the look-ahead will not be loaded any more.
    const int64_t long_past_ns = (time - Duration::fromSeconds(kFarAhead_s)).nanoseconds();
    state_->announced_ns.erase(state_->announced_ns.begin(), state_->announced_ns.lower_bound(long_past_ns));
    frame = state_->find(time);
    state_->announced_ns.erase(time.nanoseconds());
  }
  LoadedImage image = state_->imageOf(frame, time);
  const std::lock_guard lock(state_->mutex);
  state_->last = {time, image};
  return image;
}

int64_t FilmDecoder::decoded() const {
  const std::lock_guard lock(state_->mutex);
  return state_->decoded;
}

}  // namespace lodeline
