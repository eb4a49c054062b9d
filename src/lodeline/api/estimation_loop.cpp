#include "lodeline/api/estimation_loop.h"

#include <cmath>
#include <utility>

#include "lodeline/magnetometer/calibration/calibration_file.h"
#include "lodeline/util/time/time_steps.h"

namespace lodeline {
namespace {

/// The source with the magnetometer's calibration and plausible noise densities, which all later users of its
/// rig need.
RecordedSource* calibrated(const RunSettings& options, RecordedSource* source, Diagnostics* diagnostics) {
  source->setImuNoise(plausibleNoise(source->rig().imu.noise, options.shown_noise, diagnostics));
  const std::string& file = options.magnetometer_calibration;
  if (file.empty()) return source;
  Rig rig = source->rig();
  applyCalibration(readCalibrationFile(file), file, &rig);
  source->setMagnetometer(*rig.magnetometer);
  return source;
}

}  // namespace

EstimationLoop::EstimationLoop(const RunSettings& options, RecordedSource* source, Diagnostics* diagnostics)
    : diagnostics_(diagnostics),
      synchronizer_(calibrated(options, source, diagnostics), options.synchronizer, diagnostics),
      odometry_(source->rig(), options.odometry, diagnostics),
      clocks_(source->rig()),
      image_offset_(Duration::fromSeconds(source->rig().cameras.front().time_offset_to_imu_s)) {}

bool EstimationLoop::fetch() {
  fetched_ = synchronizer_.next();
  return fetched_.has_value();
}

void EstimationLoop::process() {
  processed_ = std::move(*fetched_);
  fetched_.reset();
  estimate_ = odometry_.add(processed_);
  followClocks();
  if (const std::optional<FoundDelay> found = odometry_.takeDelay()) {
    synchronizer_.delayCamera(found->camera, found->delay_s);
  }
  if (record_) record_->add(odometry_.tracks(), processed_.imu, estimate_, odometry_.estimator());
  stamp();
}

/// Compensates a clock offset found during the run in later images, except for the part that the estimator
/// has estimated.
void EstimationLoop::followClocks() {
  constexpr double kLeast_s = 0.015;
  const std::optional<double> offset_s = clocks_.add(odometry_.tracks(), processed_.imu, diagnostics_);
  if (!offset_s) return;
  const double by_s =
      *offset_s - (estimate_.camera_corrections ? estimate_.camera_corrections->time_offset_s : 0.0);
  if (std::abs(by_s) < kLeast_s) return;
  synchronizer_.moveImages(Duration::fromSeconds(by_s));
  clocks_.move(by_s);
}

/// Sets the estimate's stamp to the recorded stamp of its image, whatever corrections of clock jumps were
/// made. If the recorded stamp goes back by more than a pause, the clock before continues.
void EstimationLoop::stamp() {
  constexpr double kLongestPause_s = 10.0;
  const Time recorded = processed_.image_stamp + image_offset_;
  const bool goes_on = !last_result_stamp_ || span(*last_result_stamp_, recorded).seconds() < kLongestPause_s;
  if (goes_on && recorded != estimate_.time) {
    result_stamps_[estimate_.time] = recorded;
    estimate_.time = recorded;
  }
  has_new_stamp_ = !last_result_stamp_ || estimate_.time > *last_result_stamp_;
  if (has_new_stamp_) last_result_stamp_ = estimate_.time;
}

void EstimationLoop::finish() {
  odometry_.finish();
  if (record_) record_->finish(odometry_.estimator());
}

}  // namespace lodeline
