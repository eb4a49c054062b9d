#include "lodeline/cli/run_command.h"

#include <fmt/core.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <opencv2/core/utility.hpp>

#include "lodeline/base/error.h"
#include "lodeline/base/settings.h"
#include "lodeline/calibration/calibration_file.h"
#include "lodeline/cli/process_usage.h"
#include "lodeline/cli/run_progress.h"
#include "lodeline/cli/run_settings.h"
#include "lodeline/cli/stop_request.h"
#include "lodeline/data/euroc_source.h"
#include "lodeline/estimator/attitude_track.h"
#include "lodeline/report/landmark_writer.h"
#include "lodeline/report/output_file.h"
#include "lodeline/report/run_summary.h"
#include "lodeline/report/state_writer.h"
#include "lodeline/report/track_pictures.h"

namespace lodeline {
namespace {

using Clock = std::chrono::steady_clock;

struct RunArguments {
  std::string data;
  std::string output;
  std::string config;
  std::vector<std::string> overrides;
  std::optional<double> draw_tracks_s;
  std::string magnetometer_calibration;
  std::string magnetometer;
  std::string site;
  std::string date;
  bool quiet = false;
};

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

void loadSettings(const RunArguments& arguments, Settings* settings) {
  if (!arguments.config.empty()) settings->load(arguments.config);
  for (const std::string& override : arguments.overrides) {
    const size_t equals = override.find('=');
    if (equals == std::string::npos) throw UsageError(fmt::format("--set {}: expected KEY=VALUE", override));
    settings->set(override.substr(0, equals), override.substr(equals + 1));
  }
  if (!arguments.magnetometer.empty()) settings->set("magnetometer.model", arguments.magnetometer);
  if (!arguments.site.empty()) settings->set("heading.site", "[" + arguments.site + "]");
  if (!arguments.date.empty()) settings->set("heading.date", arguments.date);
}

void calibrateMagnetometer(const std::filesystem::path& file, EurocSource* source) {
  Rig rig = source->rig();
  applyCalibration(readCalibrationFile(file), file, &rig);
  source->setMagnetometer(*rig.magnetometer);
}

RunDescription describe(const RunArguments& arguments, const RunSettings& options, const Rig& rig) {
  RunDescription description;
  description.version = LODELINE_VERSION;
  description.data = arguments.data;
  description.config = arguments.config;
  description.overrides = arguments.overrides;
  for (const CameraCalibration& camera : rig.cameras) description.cameras.push_back(camera.name);
  description.camera_rate_hz = rig.cameras.front().rate_hz;
  description.imu_rate_hz = rig.imu.rate_hz;
  if (rig.magnetometer) description.other_sensors.push_back("magnetometer");
  if (rig.pressure) description.other_sensors.push_back("pressure");
  if (rig.sonar) description.other_sensors.push_back("sonar");
  description.observation_sigma_px = options.odometry.front_end.sigma_px;
  return description;
}

/// Feeds all packets through the estimator; results are on disk at the end, whether the recording or the
/// user ended it.
void process(Synchronizer& synchronizer, Odometry& odometry, AttitudeTrack* attitude,
             const RunArguments& arguments, RunSummary* summary) {
  const std::filesystem::path folder = arguments.output;
  StateWriter states(folder);
  LandmarkWriter landmarks(folder);
  std::optional<TrackPictures> pictures;
  if (arguments.draw_tracks_s) pictures.emplace(folder, *arguments.draw_tracks_s);
  RunProgress progress(arguments.quiet);
  const StopRequest stop;
  const Clock::time_point start = Clock::now();
  const double start_processor_s = ProcessUsage::now().processor_s;
  std::optional<FramePacket> packet = synchronizer.next();
  for (; packet && !stop.made(); packet = synchronizer.next()) {
    const FrameEstimate estimate = odometry.add(*packet);
    states.write(estimate, attitude->add(*packet));
    landmarks.write(odometry.estimator().takeMapPoints());
    if (pictures) pictures->write(*packet, odometry.frontEnd());
    summary->add(estimate);
    for (const cv::Mat& image : packet->images) summary->images += image.empty() ? 0 : 1;
    summary->wall_s = secondsSince(start);
    progress.show(*summary);
  }
  progress.end();
  landmarks.write(odometry.estimator().currentMapPoints());
  landmarks.finish();

  summary->interrupted = packet.has_value();
  summary->map_points = landmarks.count();
  summary->front_end_s = odometry.times().front_end_s;
  summary->estimator_s = odometry.times().estimator_s;
  const ProcessUsage usage = ProcessUsage::now();
  summary->process_s = usage.processor_s - start_processor_s;
  summary->peak_memory_MB = usage.peak_memory_MB;
}

/// Turns a run without a result into the error that explains it.
void requireResult(const RunArguments& arguments, const RunSummary& summary) {
  if (summary.interrupted || summary.posed() > 0) return;
  if (summary.images == 0) {
    throw InputError(fmt::format("{}: no image of the recording could be used; the findings in {} say why",
                                 arguments.data,
                                 (std::filesystem::path(arguments.output) / "run.json").string()));
  }
  throw EstimationError(fmt::format("{}: no pose after {} frames; still waiting for {}", arguments.data,
                                    summary.frames(), summary.last().waiting_for));
}

void run(const RunArguments& arguments) {
  // One thread for image operations: the same bytes on every machine, and core-milliseconds that mean
  // something.
  cv::setNumThreads(1);
  RunSettings options;
  Settings settings;
  bindRunSettings(&settings, &options);
  loadSettings(arguments, &settings);
  if (!arguments.magnetometer_calibration.empty()) {
    options.magnetometer_calibration = arguments.magnetometer_calibration;
  }

  options.odometry.estimator.magnetometer.site_field_W = siteField_W(options);

  const std::filesystem::path folder = arguments.output;
  Diagnostics diagnostics;
  EurocSource source(arguments.data, options.source, &diagnostics);
  if (!options.magnetometer_calibration.empty()) {
    calibrateMagnetometer(options.magnetometer_calibration, &source);
  }
  createOutputFolder(folder);
  std::ofstream config = openOutput(folder / "config.yaml");
  settings.write(config);
  closeOutput(folder / "config.yaml", &config);

  Synchronizer synchronizer(&source, options.synchronizer, &diagnostics);
  Odometry odometry(source.rig(), options.odometry, &diagnostics);
  RunSummary summary(describe(arguments, options, source.rig()));
  AttitudeTrack attitude(source.rig(), {}, &diagnostics);
  process(synchronizer, odometry, &attitude, arguments, &summary);
  writeOutput(folder / "run.json", summary.json(diagnostics));
  if (!arguments.quiet) fmt::print("{}\n{}", folder.string(), summary.text(diagnostics));
  requireResult(arguments, summary);
}

}  // namespace

void addRunCommand(CLI::App& program) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = program.add_subcommand("run", "Estimate a trajectory and a map from a recording");
  command->add_option("DATA", arguments->data, "folder that contains mav0 (EuRoC ASL layout), or mav0 itself")
      ->required();
  command->add_option("-o,--output", arguments->output, "folder for the results; made where it is missing")
      ->required();
  command->add_option("-c,--config", arguments->config,
                      "YAML configuration; without one, defaults serve all data");
  command->add_option("-s,--set", arguments->overrides,
                      "one setting, KEY=VALUE; goes over the configuration");
  command
      ->add_option("--draw-tracks", arguments->draw_tracks_s,
                   "write pictures of the followed points, one frame each so many seconds")
      ->type_name("SECONDS");
  command->add_option("--mag-calibration", arguments->magnetometer_calibration,
                      "what `lodeline calibrate magnetometer` wrote");
  command->add_option("--magnetometer", arguments->magnetometer,
                      "off, paper or absolute; by default absolute where it is calibrated");
  command->add_option("--site", arguments->site,
                      "LAT,LON,HEIGHT (degrees, m) of the recording, for true north");
  command->add_option("--date", arguments->date, "YYYY-MM-DD of the recording, for true north");
  command->add_flag("-q,--quiet", arguments->quiet, "no progress and no summary");
  command->footer(
      "Examples:\n"
      "  lodeline run dive1 -o dive1_result\n"
      "  lodeline run dive1 -o left_only --set source.cameras=[0]\n"
      "  lodeline run dive1 -o north --mag-calibration mag.yaml --site 29.83,-82.60,20 --date 2026-11-21\n"
      "  lodeline run dive1 -o dive1_result --draw-tracks 5\n"
      "Results: trajectory.tum, states.csv, landmarks.ply, config.yaml (all settings in effect), run.json;\n"
      "pictures of tracks in frames.");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace lodeline
