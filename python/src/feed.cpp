#include "python/src/feed.h"

#include <fmt/format.h>

#include <chrono>

namespace lodeline::python {
namespace {

constexpr size_t kQueuedImages = 20;  ///< of camera 0, from which on push() waits
constexpr size_t kMostImages = 200;   ///< in the queue of a camera
constexpr std::chrono::milliseconds kWait(20);

LiveSourceOptions liveOptions(const DescribedRig& rig, double patience_s) {
  LiveSourceOptions options;
  options.max_images = kMostImages;
  options.max_readings = 10'000'000;
  options.patience_s = patience_s;
  options.imu_correction = rig.imu_correction;
  return options;
}

}  // namespace

Feed::Feed(const DescribedRig& rig, OdometrySettings settings, double patience_s)
    : rig_(rig),
      settings_(std::move(settings)),
      patience_s_(patience_s),
      source_(rig.rig, liveOptions(rig, patience_s), &diagnostics_),
      thread_([this] { estimate(); }) {}

Feed::~Feed() {
  is_abandoned_ = true;
  source_.close();
  thread_.join();
}

void Feed::requireOpen() {
  const std::lock_guard lock(mutex_);
  rethrow();
  if (is_closed_) throw UsageError("odometry: no reading can be pushed after finish()");
}

void Feed::rethrow() const {
  if (failure_) std::rethrow_exception(failure_);
}

void Feed::push(const ImuSample& sample) {
  pushOpen(sample);
  const std::lock_guard lock(mutex_);
  newest_imu_ = sample.time;
}

bool Feed::canGoOn() const {
  if (!is_running_ || !newest_imu_ || waiting_images_.empty()) return false;
  return *newest_imu_ >= waiting_images_.front() + Duration::fromSeconds(2.0 * patience_s_);
}

UsageError Feed::stuck(size_t queued) const {
  const std::string missing =
      is_running_ ? fmt::format("inertial readings after {} ns", waiting_images_.front().nanoseconds())
                  : fmt::format("readings of {}", fmt::join(source_.unheard(), ", "));
  return UsageError(fmt::format("odometry: {} images wait for {}; push readings in the order of their times",
                                queued, missing));
}

bool Feed::push(size_t camera, Time time, const cv::Mat& pixels) {
  requireOpen();
  if (camera >= rig_.rig.cameras.size())
    throw UsageError(fmt::format("camera {}: the rig has {}", camera, rig_.rig.cameras.size()));
  const CameraCalibration& calibration = rig_.rig.cameras[camera];
  if (pixels.cols != calibration.width_px || pixels.rows != calibration.height_px) {
    throw InputError(fmt::format("{}: the image at {} ns has {} x {} px, the rig's camera {} x {} px",
                                 calibration.name, time.nanoseconds(), pixels.cols, pixels.rows,
                                 calibration.width_px, calibration.height_px));
  }
  if (camera == 0) {
    std::unique_lock lock(mutex_);
    const size_t queued = source_.backlog();
    while (waiting_images_.size() > queued) waiting_images_.pop_front();
    if (queued >= kQueuedImages && canGoOn()) {
      changed_.wait_for(lock, kWait);
      rethrow();
      return false;
    }
    if (queued + 1 >= kMostImages) throw stuck(queued);
    waiting_images_.push_back(time);
  }
  source_.push(camera, imageInMemory(time, pixels));
  return true;
}

void Feed::close() {
  {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
  }
  source_.close();
}

std::vector<FrameEstimate> Feed::take() {
  const std::lock_guard lock(mutex_);
  rethrow();
  return std::exchange(ready_, {});
}

bool Feed::waitForEnd() {
  std::unique_lock lock(mutex_);
  if (!has_ended_) changed_.wait_for(lock, kWait);
  rethrow();
  return has_ended_;
}

EstimateTable Feed::estimates() {
  const std::lock_guard lock(mutex_);
  return table_.turnedToNorth();
}

Diagnostics Feed::findings() {
  const std::lock_guard lock(mutex_);
  if (!has_ended_) throw UsageError("odometry: the findings are complete after finish()");
  return diagnostics_;
}

void Feed::estimate() {
  std::exception_ptr failure;
  try {
    if (source_.settleRates()) {
      {
        const std::lock_guard lock(mutex_);
        is_running_ = true;
      }
      Odometry odometry(&source_, settings_, &diagnostics_);
      for (bool goes_on = true; goes_on && !is_abandoned_;) {
        std::optional<FrameEstimate> estimate = odometry.next();
        goes_on = estimate.has_value();
        const std::lock_guard lock(mutex_);
        if (estimate) table_.add(*estimate);
        table_.add(odometry.takeLandmarks());
        if (estimate) ready_.push_back(std::move(*estimate));
        changed_.notify_all();
      }
    } else {
      throw EstimationError(
          "odometry: the readings ended before the rates of the IMU and of all cameras were known");
    }
  } catch (...) {
    failure = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  failure_ = failure;
  has_ended_ = true;
  changed_.notify_all();
}

}  // namespace lodeline::python
