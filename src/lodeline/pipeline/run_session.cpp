#include "lodeline/pipeline/run_session.h"

#include <cmath>
#include <filesystem>

#include "lodeline/magnetometer/calibration/calibration_file.h"
#include "lodeline/pipeline/process_usage.h"
#include "lodeline/pipeline/refine_run.h"
#include "lodeline/util/files/output_file.h"
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

AttitudeFilterOptions attitudeOptions(const RunSettings& options) {
  AttitudeFilterOptions attitude;
  attitude.site_field_W = options.odometry.estimator.magnetometer.site_field_W;
  return attitude;
}

RunDescription describe(const RunRequest& request, const RunSettings& options, const Rig& rig) {
  RunDescription description;
  description.version = LODELINE_VERSION;
  description.data = request.data;
  description.config = request.config;
  description.overrides = request.overrides;
  for (const CameraCalibration& camera : rig.cameras) description.cameras.push_back(camera.name);
  description.camera_rate_hz = rig.cameras.front().rate_hz;
  description.imu_rate_hz = rig.imu.rate_hz;
  description.camera_axis_B = rig.cameras.front().body_from_camera.rotation * Vec3::UnitZ();
  description.magnetometer = rig.magnetometer;
  description.site_field_W = options.odometry.estimator.magnetometer.site_field_W;
  if (rig.magnetometer) description.other_sensors.push_back("magnetometer");
  if (rig.pressure) description.other_sensors.push_back("pressure");
  if (rig.sonar) description.other_sensors.push_back("sonar");
  description.observation_sigma_px = options.odometry.front_end.sigma_px;
  return description;
}

void writeSettings(const std::filesystem::path& folder, const Settings& settings) {
  std::ofstream config = openOutput(folder / "config.yaml");
  settings.write(config);
  closeOutput(folder / "config.yaml", &config);
}

}  // namespace

RunSession::RunSession(const RunRequest& request, const Settings& settings, const RunSettings& options,
                       RecordedSource* source, Diagnostics* diagnostics)
    : folder_(request.output),
      diagnostics_(diagnostics),
      synchronizer_(calibrated(options, source, diagnostics), options.synchronizer, diagnostics),
      odometry_(source->rig(), options.odometry, diagnostics),
      attitude_(source->rig(), attitudeOptions(options), &unheard_),
      summary_(describe(request, options, source->rig())),
      clocks_(source->rig()),
      image_offset_(Duration::fromSeconds(source->rig().cameras.front().time_offset_to_imu_s)) {
  if (!folder_.empty()) {
    createOutputFolder(folder_);
    lock_.emplace(folder_);
    removeRefinedFiles(folder_);
    if (request.refine_interval_s) record_.emplace(*request.refine_interval_s);
    writeSettings(folder_, settings);
    output_.emplace(folder_, odometry_.estimator(),
                    RunOutputOptions{request.draw_tracks_s, request.sample_pictures});
  }
  start_ = Clock::now();
  start_processor_s_ = ProcessUsage::now().processor_s;
}

bool RunSession::fetch() {
  fetched_ = synchronizer_.next();
  return fetched_.has_value();
}

void RunSession::process() {
  processed_ = std::move(*fetched_);
  fetched_.reset();
  FrameEstimate estimate = odometry_.add(processed_);
  followClocks(estimate);
  if (const std::optional<FoundDelay> found = odometry_.takeDelay()) {
    synchronizer_.delayCamera(found->camera, found->delay_s);
  }
  if (record_) record_->add(odometry_.tracks(), processed_.imu, estimate, odometry_.estimator());
  const std::optional<AttitudeEstimate>& attitude = attitude_.add(processed_);
  const bool has_stamp = stamp(&estimate);
  landmarks_ = output_ ? output_->write(processed_, has_stamp ? &estimate : nullptr, attitude, &odometry_)
                       : odometry_.estimator().takeMapPoints();
  summary_.add(estimate);
  for (const cv::Mat& image : processed_.images) summary_.images += image.empty() ? 0 : 1;
  summary_.wall_s = std::chrono::duration<double>(Clock::now() - start_).count();
}

/// Compensates a clock offset found during the run in later images, except for the part that the estimator
/// has estimated.
void RunSession::followClocks(const FrameEstimate& estimate) {
  constexpr double kLeast_s = 0.015;
  const std::optional<double> offset_s = clocks_.add(odometry_.tracks(), processed_.imu, diagnostics_);
  if (!offset_s) return;
  const double by_s =
      *offset_s - (estimate.camera_corrections ? estimate.camera_corrections->time_offset_s : 0.0);
  if (std::abs(by_s) < kLeast_s) return;
  synchronizer_.moveImages(Duration::fromSeconds(by_s));
  clocks_.move(by_s);
}

/// Sets an estimate's stamp to the recorded stamp of its image, whatever corrections of clock jumps were
/// made. If the recorded stamp goes back by more than a pause, the clock before continues. Returns false
/// where the stamp has occurred before.
bool RunSession::stamp(FrameEstimate* estimate) {
  constexpr double kLongestPause_s = 10.0;
  const Time recorded = processed_.image_stamp + image_offset_;
  const bool goes_on = !last_result_stamp_ || span(*last_result_stamp_, recorded).seconds() < kLongestPause_s;
  if (goes_on && recorded != estimate->time) {
    result_stamps_[estimate->time] = recorded;
    estimate->time = recorded;
  }
  if (last_result_stamp_ && estimate->time <= *last_result_stamp_) return false;
  last_result_stamp_ = estimate->time;
  return true;
}

RunSummary RunSession::finish() {
  odometry_.finish();
  if (output_) summary_.map_points = output_->finish(odometry_, summary_.last().magnetometer);
  if (output_) summary_.pictures_s = output_->picturesSeconds();
  output_.reset();  // closes files that are read next
  summary_.interrupted = fetched_.has_value();
  if (!summary_.interrupted) summary_.recorded_images = synchronizer_.recordedImages();
  summary_.front_end_s = odometry_.times().front_end_s;
  summary_.estimator_s = odometry_.times().estimator_s;
  ProcessUsage usage = ProcessUsage::now();
  summary_.process_s = usage.processor_s - start_processor_s_;
  if (record_) {
    record_->finish(odometry_.estimator());
    summary_.refinement = refineRun(odometry_.estimator(), *record_, folder_, result_stamps_, diagnostics_);
    usage = ProcessUsage::now();
  }
  summary_.peak_memory_MB = usage.peak_memory_MB;
  summary_.reportBlindStretches(diagnostics_);
  if (!folder_.empty())
    writeOutput(std::filesystem::path(folder_) / "run.json", summary_.json(*diagnostics_));
  return summary_;
}

}  // namespace lodeline
