#include "lodeline/io/synchronizer/synchronizer.h"

#include <fmt/core.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/io/synchronizer/inertial_stream.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

/// Whether another image of the first camera comes; waits for it. A live source that gave an image may end
/// once before the next one, when this one is late.
bool hasNext(OrderedStream<PendingImage>* images, bool is_live) {
  return images->peek() != nullptr || (is_live && images->peek() != nullptr);
}

}  // namespace

Synchronizer::Synchronizer(MeasurementSource* source, const SynchronizerOptions& options,
                           Diagnostics* diagnostics)
    : source_(source),
      options_(options),
      diagnostics_(diagnostics),
      imu_(inertialReadings(), options.history_s),
      histories_(source->rig().cameras.size()),
      repeats_(source->rig(), diagnostics),
      sensors_(
          source,
          [this](const char* kind, const char* name, double rate_hz) {
            return expectation(kind, name, rate_hz);
          },
          diagnostics) {
  const std::vector<CameraCalibration>& cameras = source->rig().cameras;
  if (cameras.empty()) throw InputError("the recording has no camera; at least one is needed");
  for (size_t i = 0; i < cameras.size(); ++i) cameras_.push_back(imageStream(i));
}

OrderedStream<PendingImage> Synchronizer::imageStream(size_t camera) {
  constexpr size_t kImagesAhead = 8;
  const CameraCalibration& calibration = source_->rig().cameras[camera];
  StreamExpectation expected = expectation("image", calibration.name, calibration.rate_hz);
  const double found_s = camera < options_.image_offset_s.size() ? options_.image_offset_s[camera] : 0.0;
  expected.offset_to_imu_clock = Duration::fromSeconds(calibration.time_offset_to_imu_s + found_s);
  expected.spreads_bursts = false;
  // Where an image of a live camera is lost, the next one does not wait for its successor.
  expected.look_ahead = source_->isLive() ? 0 : std::min(expected.look_ahead, kImagesAhead);
  // A gap of another camera is reported per packet as a missing partner.
  expected.max_gap_s = camera == 0 ? options_.max_image_gap_periods / calibration.rate_hz : 0.0;
  const auto pull = [this, camera] {
    std::optional<PendingImage> image = source_->nextImage(camera);
    if (image) image->recorded = image->time;
    return image;
  };
  return {std::move(expected), pull, diagnostics_};
}

StreamExpectation Synchronizer::expectation(const char* kind, const std::string& name, double rate_hz) const {
  StreamExpectation expected;
  expected.kind = kind;
  expected.name = name;
  expected.rate_hz = rate_hz;
  expected.max_gap_s = rate_hz > 0.0 ? options_.max_gap_periods / rate_hz : 0.0;
  if (source_->isLive()) expected.look_ahead = 1;
  const bool has_even_rate = expected.kind == "imu" || expected.kind == "magnetometer";
  expected.spreads_bursts = has_even_rate && !source_->isLive();
  return expected;
}

ImuIntervals::Pull Synchronizer::inertialReadings() const {
  OrderedStream<ImuSample> ordered(
      expectation("imu", "IMU", source_->rig().imu.rate_hz), [source = source_] { return source->nextImu(); },
      diagnostics_);
  const auto screen =
      std::make_shared<InertialScreen>(inertialStream(std::move(ordered), options_.inertial, diagnostics_));
  return [screen]() -> std::optional<ImuSample> {
    if (screen->peek() == nullptr) return std::nullopt;
    return screen->pop();
  };
}

std::optional<FramePacket> Synchronizer::next() {
  std::optional<FramePacket> repeated;
  while (std::optional<FramePacket> packet = nextOfImage()) {
    const ImageRepeats::Reference reference = repeats_.screen(&*packet);
    if (repeated) packet->prepend(std::move(*repeated));
    if (reference != ImageRepeats::Reference::Repeat) return packet;
    repeated = std::move(packet);
  }
  repeats_.finish();
  checkSizes();
  return repeated;
}

std::optional<FramePacket> Synchronizer::nextOfImage() {
  std::optional<Draft> draft = started_ && options_.prefetch ? std::move(prefetched_) : draftNext();
  if (!draft) return std::nullopt;
  if (options_.prefetch) {
    if (!started_) startDecoding(&*draft);
    prefetched_ = draftNext();
    if (prefetched_) startDecoding(&*prefetched_);
  }
  started_ = true;
  return finish(std::move(*draft));
}

std::optional<Synchronizer::Draft> Synchronizer::draftNext() {
  while (hasNext(&cameras_[0], source_->isLive())) {
    Draft draft;
    PendingImage reference = cameras_[0].pop();
    if (!first_image_time_) first_image_time_ = reference.time;
    const double since_start_s = span(reference.time, *first_image_time_).seconds();
    if (since_start_s < options_.skip_s) continue;
    if (options_.duration_s > 0.0 && since_start_s > options_.skip_s + options_.duration_s) {
      reportApart(false);
      return {};
    }
    ++recorded_images_;
    if (last_packet_time_) followClocks(&reference);
    if (last_packet_time_ && reference.time <= *last_packet_time_) continue;
    last_image_time_ = reference.time;
    images_span_.add(reference.time);
    if (!coveredByImu(reference)) continue;

    draft.packet.time = reference.time;
    draft.packet.image_stamp = reference.recorded;
    draft.packet.imu = imu_.cut(reference.time, &draft.packet.longest_imu_gap_s);
    const Time oldest =
        last_packet_time_ ? *last_packet_time_ : reference.time - Duration::fromSeconds(options_.history_s);
    draft.packet.readings = sensors_.takeUntil(reference.time, oldest);
    draft.packet.image_delays_s = {0.0};
    double latest_s = 0.0;
    for (size_t i = 1; i < cameras_.size(); ++i) {
      draft.pending.push_back(partnerOf(reference, i));
      const std::optional<PendingImage>& partner = draft.pending.back();
      draft.packet.image_delays_s.push_back(partner ? delay_s(reference, *partner, i) : 0.0);
      latest_s = std::max(latest_s, draft.packet.image_delays_s.back());
    }
    if (latest_s > 0.0) {
      draft.packet.imu_ahead = imu_.ahead(reference.time + Duration::fromSeconds(latest_s));
    }
    last_packet_time_ = reference.time;
    draft.pending.insert(draft.pending.begin(), std::move(reference));
    return draft;
  }
  reportApart(!source_->isLive());
  return std::nullopt;
}

bool Synchronizer::coveredByImu(const PendingImage& image) {
  switch (imu_.readUntil(image.time)) {
    case ImuIntervals::Coverage::Covered:
      return true;
    case ImuIntervals::Coverage::BeforeFirst:
      diagnostics_->report(Severity::Warning, "image_before_imu",
                           fmt::format("{}: image at {} ns lies before the first IMU reading; passed over",
                                       image.name, image.time.nanoseconds()));
      return false;
    case ImuIntervals::Coverage::AfterLast:
      diagnostics_->report(Severity::Warning, "image_after_imu",
                           fmt::format("{}: image at {} ns lies after the last IMU reading; passed over",
                                       image.name, image.time.nanoseconds()));
      return false;
  }
  return false;
}

std::optional<PendingImage> Synchronizer::partnerOf(const PendingImage& reference, size_t camera) {
  const double period_s = 1.0 / source_->rig().cameras[0].rate_hz;
  const Duration tolerance = Duration::fromSeconds(std::min(options_.match_tolerance_s, 0.5 * period_s));
  OrderedStream<PendingImage>& stream = cameras_[camera];
  const auto distance = [&](const PendingImage& image) {
    return image.time < reference.time ? reference.time - image.time : image.time - reference.time;
  };
  while (stream.peek() != nullptr) {
    // A live stream may not have its next image yet. It cannot be nearer to the reference than one just
    // before it.
    bool ends = false;
    if ((reference.time - stream.peek()->time).seconds() > 0.25 * period_s) stream.reach(2, &ends);
    const bool is_next_nearer =
        stream.following() != nullptr && distance(*stream.following()) <= distance(*stream.peek());
    if (stream.peek()->time >= reference.time - tolerance && !is_next_nearer) break;
    const PendingImage orphan = stream.pop();
    histories_[camera].span.add(orphan.time);
    // Images from before the used part of the recording cannot have a partner.
    if (!last_packet_time_) continue;
    diagnostics_->report(Severity::Notice, "image_without_partner",
                         fmt::format("{}: no image of {} within {:g} ms has it as the nearest; passed over",
                                     orphan.name, source_->rig().cameras[0].name, tolerance.seconds() * 1e3));
  }
  if (stream.peek() != nullptr && stream.peek()->time <= reference.time + tolerance) {
    ++histories_[camera].partners;
    histories_[camera].span.add(stream.peek()->time);
    return stream.pop();
  }
  diagnostics_->report(
      Severity::Warning, "image_missing",
      fmt::format("{}: no image within {:g} ms of stamp {} ns", source_->rig().cameras[camera].name,
                  tolerance.seconds() * 1e3, reference.time.nanoseconds()));
  return std::nullopt;
}

double Synchronizer::delay_s(const PendingImage& reference, const PendingImage& partner, size_t camera) {
  // Software stamps have jitter, but the trigger delay between two cameras is constant.
  constexpr size_t kLatest = 31;
  constexpr double kTremble_s = 3e-3;
  const double by_stamps_s = (partner.time - reference.time).seconds();
  std::deque<double>& latest = histories_[camera].delays_s;
  latest.push_back(by_stamps_s);
  if (latest.size() > kLatest) latest.pop_front();
  const double usual_s = median(std::vector<double>(latest.begin(), latest.end()));
  return std::abs(by_stamps_s - usual_s) < kTremble_s ? usual_s : by_stamps_s;
}

void Synchronizer::startDecoding(Draft* draft) const {
  for (const std::optional<PendingImage>& pending : draft->pending) {
    draft->decoding.push_back(pending ? std::async(std::launch::async, pending->load)
                                      : std::future<LoadedImage>());
  }
}

FramePacket Synchronizer::finish(Draft draft) {
  draft.packet.images.resize(draft.pending.size());
  for (size_t i = 0; i < draft.pending.size(); ++i) {
    if (!draft.pending[i]) continue;
    LoadedImage loaded = draft.decoding.empty() ? draft.pending[i]->load() : draft.decoding[i].get();
    storeImage(i, *draft.pending[i], std::move(loaded), &draft.packet);
  }
  return std::move(draft.packet);
}

void Synchronizer::storeImage(size_t camera, const PendingImage& pending, LoadedImage loaded,
                              FramePacket* packet) {
  if (loaded.image.empty()) {
    diagnostics_->report(Severity::Warning, "image_unreadable",
                         fmt::format("{}; carrying on without the image of {} ns", loaded.problem,
                                     pending.time.nanoseconds()));
    return;
  }
  const CameraCalibration& expected = source_->rig().cameras[camera];
  CameraHistory& history = histories_[camera];
  if (loaded.image.cols == expected.width_px && loaded.image.rows == expected.height_px) {
    ++history.right_size;
    packet->images[camera] = std::move(loaded.image);
    return;
  }
  const std::string problem =
      fmt::format("{}: image is {} x {} px but the calibration of {} says {} x {}", pending.name,
                  loaded.image.cols, loaded.image.rows, expected.name, expected.width_px, expected.height_px);
  if (history.other_size++ == 0) history.size_problem = problem;
  diagnostics_->report(Severity::Warning, "image_size", problem + "; carrying on without such images");
  constexpr int kEnough = 5;
  if (history.other_size >= kEnough) checkSizes();
}

void Synchronizer::checkSizes() const {
  for (const CameraHistory& history : histories_) {
    if (history.right_size > 0 || history.other_size == 0) continue;
    throw InputError(fmt::format(
        "{}; calibrate at the size of the recording, scale intrinsics and resolution, or leave the "
        "camera out (source.cameras)",
        history.size_problem));
  }
}

void Synchronizer::delayCamera(size_t camera, double by_s) {
  cameras_[camera].shift(Duration::fromSeconds(by_s));
  histories_[camera].delays_s.clear();
}

void Synchronizer::moveImages(Duration by) {
  for (OrderedStream<PendingImage>& camera : cameras_) {
    const PendingImage* next = camera.peek();
    if (next != nullptr) camera.shiftFrom(next->time, by);
  }
  if (last_image_time_) last_image_time_ = moved(*last_image_time_, by);
}

size_t Synchronizer::bufferedReadings() const { return imu_.size(); }

}  // namespace lodeline
