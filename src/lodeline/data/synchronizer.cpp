#include "lodeline/data/synchronizer.h"

#include <fmt/core.h>

#include <algorithm>

#include "lodeline/base/error.h"
#include "lodeline/data/inertial_stream.h"

namespace lodeline {
namespace {

/// Readings up to `time`, less those older than `oldest`.
template <typename Reading>
std::vector<Reading> takeUntil(Time time, Time oldest, OrderedStream<Reading>* stream) {
  std::vector<Reading> taken;
  while (stream->peek() != nullptr && stream->peek()->time <= time) {
    Reading reading = stream->pop();
    if (reading.time >= oldest) taken.push_back(std::move(reading));
  }
  return taken;
}

template <typename Sensor>
double rateOf(const std::optional<Sensor>& sensor) {
  return sensor ? sensor->rate_hz : 0.0;
}

}  // namespace

Synchronizer::Synchronizer(MeasurementSource* source, const SynchronizerOptions& options,
                           Diagnostics* diagnostics)
    : source_(source),
      options_(options),
      diagnostics_(diagnostics),
      imu_(inertialReadings(), options.history_s),
      magnetometer_(
          magnetometerExpectation(), [source] { return source->nextMagnetometer(); }, diagnostics),
      depth_(
          expectation("depth", "pressure sensor", rateOf(source->rig().pressure)),
          [source] { return source->nextDepth(); }, diagnostics),
      sonar_(
          expectation("sonar", "sonar", rateOf(source->rig().sonar)),
          [source] { return source->nextSonar(); }, diagnostics) {
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
  expected.look_ahead = std::min(expected.look_ahead, kImagesAhead);
  // A gap of another camera shows, packet by packet, as a missing partner.
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

StreamExpectation Synchronizer::magnetometerExpectation() const {
  const std::optional<MagnetometerCalibration>& magnetometer = source_->rig().magnetometer;
  StreamExpectation expected = expectation("magnetometer", "magnetometer", rateOf(magnetometer));
  if (magnetometer) expected.offset_to_imu_clock = Duration::fromSeconds(magnetometer->time_offset_to_imu_s);
  return expected;
}

std::optional<FramePacket> Synchronizer::next() {
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
  while (cameras_[0].peek() != nullptr) {
    Draft draft;
    PendingImage reference = cameras_[0].pop();
    if (!first_image_time_) first_image_time_ = reference.time;
    const double since_start_s = span(reference.time, *first_image_time_).seconds();
    if (since_start_s < options_.skip_s) continue;
    if (options_.duration_s > 0.0 && since_start_s > options_.skip_s + options_.duration_s) return {};
    ++recorded_images_;
    if (last_packet_time_) followClocks(&reference);
    last_image_time_ = reference.time;
    if (!coveredByImu(reference)) continue;

    draft.packet.time = reference.time;
    draft.packet.image_stamp = reference.recorded;
    draft.packet.imu = imu_.cut(reference.time, &draft.packet.longest_imu_gap_s);
    const Time oldest =
        last_packet_time_ ? *last_packet_time_ : reference.time - Duration::fromSeconds(options_.history_s);
    draft.packet.magnetometer = takeUntil(reference.time, oldest, &magnetometer_);
    draft.packet.depth = takeUntil(reference.time, oldest, &depth_);
    draft.packet.sonar = takeUntil(reference.time, oldest, &sonar_);
    for (size_t i = 1; i < cameras_.size(); ++i) draft.pending.push_back(partnerOf(reference, i));
    last_packet_time_ = reference.time;
    draft.pending.insert(draft.pending.begin(), std::move(reference));
    return draft;
  }
  if (first_image_time_ && !last_packet_time_) reportApart();
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
  const Duration tolerance = Duration::fromSeconds(std::min(options_.match_tolerance_s, 0.4 * period_s));
  OrderedStream<PendingImage>& stream = cameras_[camera];
  while (stream.peek() != nullptr && stream.peek()->time < reference.time - tolerance) {
    const PendingImage orphan = stream.pop();
    // Those from before the part of the recording that is used never had a chance of a partner.
    if (!last_packet_time_) continue;
    diagnostics_->report(Severity::Notice, "image_without_partner",
                         fmt::format("{}: no image of {} within {:g} ms; passed over", orphan.name,
                                     source_->rig().cameras[0].name, tolerance.seconds() * 1e3));
  }
  if (stream.peek() != nullptr && stream.peek()->time <= reference.time + tolerance) return stream.pop();
  diagnostics_->report(
      Severity::Warning, "image_missing",
      fmt::format("{}: no image within {:g} ms of stamp {} ns", source_->rig().cameras[camera].name,
                  tolerance.seconds() * 1e3, reference.time.nanoseconds()));
  return std::nullopt;
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
  if (loaded.image.cols != expected.width_px || loaded.image.rows != expected.height_px) {
    throw InputError(fmt::format(
        "{}: image is {} x {} px but the calibration of {} says {} x {}; calibrate at the size of the "
        "recording, or scale intrinsics and resolution",
        pending.name, loaded.image.cols, loaded.image.rows, expected.name, expected.width_px,
        expected.height_px));
  }
  packet->images[camera] = std::move(loaded.image);
}

size_t Synchronizer::bufferedReadings() const { return imu_.size(); }

}  // namespace lodeline
