#include "lodeline/cli/run_recording.h"

#include <fmt/core.h>

#include <chrono>
#include <filesystem>
#include <opencv2/core/utility.hpp>

#include "lodeline/base/error.h"
#include "lodeline/base/output_file.h"
#include "lodeline/base/settings.h"
#include "lodeline/calibration/calibration_file.h"
#include "lodeline/cli/process_usage.h"
#include "lodeline/cli/run_progress.h"
#include "lodeline/cli/stop_request.h"
#include "lodeline/estimator/attitude_track.h"
#include "lodeline/live/live_view.h"
#include "lodeline/report/run_output.h"

namespace lodeline {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void calibrateMagnetometer(const std::filesystem::path& file, RecordedSource* source) {
  Rig rig = source->rig();
  applyCalibration(readCalibrationFile(file), file, &rig);
  source->setMagnetometer(*rig.magnetometer);
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
  if (rig.magnetometer) description.other_sensors.push_back("magnetometer");
  if (rig.pressure) description.other_sensors.push_back("pressure");
  if (rig.sonar) description.other_sensors.push_back("sonar");
  description.observation_sigma_px = options.odometry.front_end.sigma_px;
  return description;
}

/// Feeds all packets through the estimator; results are on disk at the end, whether the recording or the
/// user ended it.
void process(Synchronizer& synchronizer, Odometry& odometry, AttitudeTrack* attitude, const Rig& rig,
             const RunRequest& request, RunSummary* summary) {
  RunOutput output(request.output, rig, {request.draw_tracks_s, request.sample_pictures});
  std::optional<LiveView> live;
  if (request.live_port) {
    const std::string name = std::filesystem::absolute(request.output).filename().string();
    live.emplace(request.live_address, *request.live_port, name, request.data, rig);
    if (!request.quiet) fmt::print(stderr, "live at {}\n", live->url());
  }
  RunProgress progress(request.quiet);
  const StopRequest stop;
  const Clock::time_point start = Clock::now();
  const double start_processor_s = ProcessUsage::now().processor_s;
  std::optional<FramePacket> packet = synchronizer.next();
  for (; packet && !stop.made(); packet = synchronizer.next()) {
    const FrameEstimate estimate = odometry.add(*packet);
    output.write(*packet, estimate, attitude->add(*packet), &odometry);
    summary->add(estimate);
    for (const cv::Mat& image : packet->images) summary->images += image.empty() ? 0 : 1;
    summary->wall_s = secondsSince(start);
    if (live) live->show(*packet, estimate, *summary, odometry.frontEnd());
    progress.show(*summary);
  }
  progress.end();

  summary->map_points = output.finish(odometry);
  summary->interrupted = packet.has_value();
  summary->front_end_s = odometry.times().front_end_s;
  summary->estimator_s = odometry.times().estimator_s;
  const ProcessUsage usage = ProcessUsage::now();
  summary->process_s = usage.processor_s - start_processor_s;
  summary->peak_memory_MB = usage.peak_memory_MB;
}

}  // namespace

void applyRequest(const RunRequest& request, Settings* settings, RunSettings* options) {
  bindRunSettings(settings, options);
  if (!request.config.empty()) settings->load(request.config);
  for (const std::string& override : request.overrides) {
    const size_t equals = override.find('=');
    if (equals == std::string::npos) throw UsageError(fmt::format("--set {}: expected KEY=VALUE", override));
    settings->set(override.substr(0, equals), override.substr(equals + 1));
  }
  if (!request.magnetometer.empty()) settings->set("magnetometer.model", request.magnetometer);
  if (!request.site.empty()) settings->set("heading.site", "[" + request.site + "]");
  if (!request.date.empty()) settings->set("heading.date", request.date);
  if (!request.magnetometer_calibration.empty()) {
    options->magnetometer_calibration = request.magnetometer_calibration;
  }
  options->odometry.estimator.magnetometer.site_field_W = siteField_W(*options);
}

RunSummary runRecording(const RunRequest& request, Diagnostics* diagnostics) {
  // One thread for image operations: the same bytes on every machine, and core-milliseconds that mean
  // something.
  cv::setNumThreads(1);
  RunSettings options;
  Settings settings;
  applyRequest(request, &settings, &options);

  const std::filesystem::path folder = request.output;
  const std::unique_ptr<RecordedSource> source =
      openRecording(request.data, options.source, request.bag, diagnostics);
  if (!options.magnetometer_calibration.empty()) {
    calibrateMagnetometer(options.magnetometer_calibration, source.get());
  }
  createOutputFolder(folder);
  std::ofstream config = openOutput(folder / "config.yaml");
  settings.write(config);
  closeOutput(folder / "config.yaml", &config);

  Synchronizer synchronizer(source.get(), options.synchronizer, diagnostics);
  Odometry odometry(source->rig(), options.odometry, diagnostics);
  RunSummary summary(describe(request, options, source->rig()));
  AttitudeFilterOptions attitude_options;
  attitude_options.site_field_W = options.odometry.estimator.magnetometer.site_field_W;
  Diagnostics unheard;  // what the filter finds wrong with readings, synchroniser and odometry report too
  AttitudeTrack attitude(source->rig(), attitude_options, &unheard);
  process(synchronizer, odometry, &attitude, source->rig(), request, &summary);
  writeOutput(folder / "run.json", summary.json(*diagnostics));
  return summary;
}

}  // namespace lodeline
