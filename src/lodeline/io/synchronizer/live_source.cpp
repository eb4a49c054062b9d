#include "lodeline/recording.h"

#include <fmt/core.h>

#include <algorithm>
#include <type_traits>

#include "lodeline/io/streams/stream_rate.h"

namespace lodeline {
namespace {

constexpr size_t kImagesForRate = 20;

}  // namespace

LiveSource::LiveSource(const Rig& rig, const LiveSourceOptions& options, Diagnostics* diagnostics)
    : RecordedSource(rig, options.imu_correction), options_(options), diagnostics_(diagnostics) {
  options_.max_images = std::max(options_.max_images, kImagesForRate);
  const auto prepare = [](auto* inbox, const char* kind, const std::string& name, size_t limit) {
    inbox->kind = kind;
    inbox->name = name;
    inbox->limit = limit;
  };
  prepare(&imu_, "imu", "IMU", options_.max_readings);
  prepare(&magnetometer_, "magnetometer", "magnetometer", options_.max_readings);
  prepare(&depth_, "depth", "pressure sensor", options_.max_readings);
  prepare(&sonar_, "sonar", "sonar", options_.max_readings);
  prepare(&altimeter_, "altimeter", "altimeter", options_.max_readings);
  prepare(&dvl_, "dvl", "DVL", options_.max_readings);
  prepare(&currents_, "current", "current sensor", options_.max_readings);
  if (rig.dvl) dvl_.offset_to_imu_clock = Duration::fromSeconds(rig.dvl->time_offset_to_imu_s);
  if (rig.currents) {
    currents_.offset_to_imu_clock = Duration::fromSeconds(rig.currents->time_offset_to_imu_s);
  }
  if (rig.magnetometer) {
    magnetometer_.offset_to_imu_clock = Duration::fromSeconds(rig.magnetometer->time_offset_to_imu_s);
  }
  cameras_.resize(rig.cameras.size());
  for (size_t i = 0; i < cameras_.size(); ++i) {
    prepare(&cameras_[i], "image", rig.cameras[i].name, options_.max_images);
    cameras_[i].offset_to_imu_clock = Duration::fromSeconds(rig.cameras[i].time_offset_to_imu_s);
  }
}

template <typename Reading>
void LiveSource::put(Inbox<Reading>* inbox, Reading reading) {
  const std::lock_guard lock(mutex_);
  if (closed_) return;
  ++inbox->heard;
  const auto lose = [](Time time, Loss* loss) {
    if (loss->count++ == 0) loss->first = time;
  };
  if (inbox->settled && reading.time + inbox->offset_to_imu_clock <= *inbox->settled) {
    lose(reading.time, &inbox->late);
    return;
  }
  inbox->waiting.push_back(std::move(reading));
  if (inbox->waiting.size() > inbox->limit) {
    // Before the first image is taken, other dropped readings are not needed and not counted.
    constexpr bool kIsImage = std::is_same_v<Reading, PendingImage>;
    if (kIsImage || newest_image_) lose(inbox->waiting.front().time, &inbox->overflow);
    inbox->waiting.pop_front();
  }
  changed_.notify_all();
}

void LiveSource::push(const ImuSample& sample) {
  put(&imu_, sample);
  const std::lock_guard lock(mutex_);
  newest_imu_ = sample.time;
  changed_.notify_all();
}
void LiveSource::push(const MagnetometerSample& sample) { put(&magnetometer_, sample); }
void LiveSource::push(const DepthSample& sample) { put(&depth_, sample); }
void LiveSource::push(const SonarSample& sample) { put(&sonar_, sample); }
void LiveSource::push(const AltimeterSample& sample) { put(&altimeter_, sample); }
void LiveSource::push(const DvlSample& sample) { put(&dvl_, sample); }
void LiveSource::push(const CurrentSample& sample) { put(&currents_, sample); }
void LiveSource::push(size_t camera, PendingImage image) { put(&cameras_[camera], std::move(image)); }

void LiveSource::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

size_t LiveSource::backlog() const {
  const std::lock_guard lock(mutex_);
  return cameras_.empty() ? 0 : cameras_.front().waiting.size();
}

std::vector<std::string> LiveSource::unheard() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> names;
  if (imu_.heard < kStampsForRate) names.push_back(imu_.name);
  for (const Inbox<PendingImage>& camera : cameras_) {
    if (camera.heard < kImagesForRate) names.push_back(camera.name);
  }
  return names;
}

bool LiveSource::isHeard() const {
  return imu_.heard >= kStampsForRate &&
         std::all_of(cameras_.begin(), cameras_.end(),
                     [](const Inbox<PendingImage>& camera) { return camera.heard >= kImagesForRate; });
}

template <typename Reading>
void LiveSource::settleRate(const Inbox<Reading>& inbox, double fallback_hz, double* rate_hz) {
  std::vector<Time> stamps;
  for (const Reading& reading : inbox.waiting) {
    if (stamps.size() < kStampsForRate) stamps.push_back(reading.time);
  }
  *rate_hz = lodeline::settleRate(inbox.name, stamps, *rate_hz, diagnostics_);
  if (!(*rate_hz > 0.0)) *rate_hz = fallback_hz;
}

bool LiveSource::settleRates() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return closed_ || isHeard(); });
  settleRate(imu_, ImuCalibration().rate_hz, &rig_.imu.rate_hz);
  for (size_t i = 0; i < cameras_.size(); ++i) {
    settleRate(cameras_[i], CameraCalibration().rate_hz, &rig_.cameras[i].rate_hz);
  }
  if (rig_.magnetometer) {
    settleRate(magnetometer_, MagnetometerCalibration().rate_hz, &rig_.magnetometer->rate_hz);
  }
  if (rig_.pressure) settleRate(depth_, PressureCalibration().rate_hz, &rig_.pressure->rate_hz);
  if (rig_.sonar) settleRate(sonar_, SonarCalibration().rate_hz, &rig_.sonar->rate_hz);
  if (rig_.altimeter) settleRate(altimeter_, SonarCalibration().rate_hz, &rig_.altimeter->rate_hz);
  if (rig_.dvl) settleRate(dvl_, DvlCalibration().rate_hz, &rig_.dvl->rate_hz);
  if (rig_.currents) settleRate(currents_, CurrentCalibration().rate_hz, &rig_.currents->rate_hz);
  return isHeard();
}

bool LiveSource::patienceIsOver() const {
  return newest_imu_ && newest_image_ && (*newest_imu_ - *newest_image_).seconds() > options_.patience_s;
}

template <typename Reading>
void LiveSource::reportLosses(Inbox<Reading>* inbox) {
  const auto report = [&](const char* what, const char* why, Loss* loss) {
    if (loss->count == 0) return;
    diagnostics_->report(Severity::Warning, fmt::format("{}_{}", inbox->kind, what),
                         fmt::format("{}: {} from stamp {} ns on {}", inbox->name, loss->count,
                                     loss->first.nanoseconds(), why));
    *loss = {};
  };
  report("dropped", "found no room: the estimator does not keep up, or waited for another sensor",
         &inbox->overflow);
  report("late", "came after the poses that they belong to; is the clock of the sensor off?", &inbox->late);
}

template <typename Reading>
std::optional<Reading> LiveSource::take(Inbox<Reading>* inbox, bool waits_on) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return closed_ || !inbox->waiting.empty() || (!waits_on && patienceIsOver()); });
  reportLosses(inbox);
  if (inbox->waiting.empty()) {
    inbox->settled = inbox->given;
    if (newest_image_) inbox->settled = std::max(*newest_image_, inbox->given.value_or(*newest_image_));
    return std::nullopt;
  }
  Reading reading = std::move(inbox->waiting.front());
  inbox->waiting.pop_front();
  inbox->given = reading.time + inbox->offset_to_imu_clock;
  return reading;
}

std::optional<ImuSample> LiveSource::nextRecordedImu() { return take(&imu_, true); }

std::optional<PendingImage> LiveSource::nextImage(size_t camera) {
  if (camera > 0) return take(&cameras_[camera], false);
  std::optional<PendingImage> image = take(&cameras_[0], !image_follows_);
  image_follows_ = image.has_value();
  if (image) {
    const std::lock_guard lock(mutex_);
    newest_image_ = image->time + cameras_[0].offset_to_imu_clock;
  }
  return image;
}

std::optional<MagnetometerSample> LiveSource::nextMagnetometer() {
  if (!rig_.magnetometer) return std::nullopt;
  return take(&magnetometer_, false);
}

std::optional<DepthSample> LiveSource::nextDepth() {
  if (!rig_.pressure) return std::nullopt;
  return take(&depth_, false);
}

std::optional<SonarSample> LiveSource::nextSonar() {
  if (!rig_.sonar) return std::nullopt;
  return take(&sonar_, false);
}

std::optional<AltimeterSample> LiveSource::nextAltimeter() {
  if (!rig_.altimeter) return std::nullopt;
  return take(&altimeter_, false);
}

std::optional<DvlSample> LiveSource::nextDvl() {
  if (!rig_.dvl) return std::nullopt;
  return take(&dvl_, false);
}

std::optional<CurrentSample> LiveSource::nextCurrents() {
  if (!rig_.currents) return std::nullopt;
  return take(&currents_, false);
}

}  // namespace lodeline
