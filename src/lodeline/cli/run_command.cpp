#include "lodeline/cli/run_command.h"

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <opencv2/core/utility.hpp>

#include "lodeline/base/error.h"
#include "lodeline/base/settings.h"
#include "lodeline/base/thread_clock.h"
#include "lodeline/cli/run_settings.h"
#include "lodeline/data/euroc_source.h"
#include "lodeline/report/landmark_writer.h"
#include "lodeline/report/output_file.h"
#include "lodeline/report/run_summary.h"
#include "lodeline/report/state_writer.h"

namespace lodeline {
namespace {

using Clock = std::chrono::steady_clock;

struct RunArguments {
  std::string data;
  std::string output;
  std::string config;
  std::vector<std::string> overrides;
  bool quiet = false;
};

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double processSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// One line that is rewritten on a terminal, or a line each ten seconds of recording in a log.
class Progress {
 public:
  explicit Progress(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO)) {}

  void show(const RunSummary& summary) {
    if (quiet_ || secondsSince(last_) < (terminal_ ? 0.2 : 5.0)) return;
    last_ = Clock::now();
    const FrameEstimate& frame = summary.last();
    const std::string state = frame.status == Status::Waiting
                                  ? "waiting for " + frame.waiting_for
                                  : fmt::format("{}, {} tracks, {} landmarks", toString(frame.status),
                                                frame.tracks, frame.landmarks);
    fmt::print(stderr, "{}frame {:6}  {:5.1f} x real time  {:.1f} m  {}{}", terminal_ ? "\r\033[K" : "",
               summary.frames(), summary.realTimeFactor(), summary.pathLength_m(), state,
               terminal_ ? "" : "\n");
  }
  void end() const {
    if (!quiet_ && terminal_) fmt::print(stderr, "\r\033[K");
  }

 private:
  bool quiet_;
  bool terminal_;
  Clock::time_point last_ = Clock::now();
};

void createFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw InputError(fmt::format("{}: cannot be created ({}); choose another folder with -o", folder.string(),
                                 error.message()));
  }
}

void loadSettings(const RunArguments& arguments, Settings* settings) {
  if (!arguments.config.empty()) settings->load(arguments.config);
  for (const std::string& override : arguments.overrides) {
    const size_t equals = override.find('=');
    if (equals == std::string::npos) throw UsageError(fmt::format("--set {}: expected KEY=VALUE", override));
    settings->set(override.substr(0, equals), override.substr(equals + 1));
  }
}

void run(const RunArguments& arguments) {
  // One thread for image operations: the same bytes on every machine, and core-milliseconds that mean
  // something.
  cv::setNumThreads(1);
  RunSettings options;
  Settings settings;
  bindRunSettings(&settings, &options);
  loadSettings(arguments, &settings);

  const std::filesystem::path folder = arguments.output;
  Diagnostics diagnostics;
  EurocSource source(arguments.data, options.source, &diagnostics);
  createFolder(folder);
  std::ofstream config = openOutput(folder / "config.yaml");
  settings.write(config);
  config.close();

  Synchronizer synchronizer(&source, options.synchronizer, &diagnostics);
  Odometry odometry(source.rig(), options.odometry, &diagnostics);
  StateWriter states(folder);
  LandmarkWriter landmarks(folder);
  RunSummary summary;
  Progress progress(arguments.quiet);
  const Clock::time_point start = Clock::now();
  const double start_process_s = processSeconds();
  const auto next = [&] {
    const double before_s = threadSeconds();
    std::optional<FramePacket> packet = synchronizer.next();
    summary.reading_s += threadSeconds() - before_s;
    return packet;
  };
  while (const std::optional<FramePacket> packet = next()) {
    const FrameEstimate estimate = odometry.add(*packet);
    states.write(estimate);
    landmarks.write(odometry.estimator().takeMapPoints());
    summary.add(estimate);
    summary.wall_s = secondsSince(start);
    progress.show(summary);
  }
  progress.end();
  landmarks.write(odometry.estimator().currentMapPoints());
  landmarks.finish();

  summary.map_points = landmarks.count();
  summary.front_end_s = odometry.times().front_end_s;
  summary.estimator_s = odometry.times().estimator_s;
  summary.process_s = processSeconds() - start_process_s;
  openOutput(folder / "run.json") << summary.json(diagnostics);
  if (!arguments.quiet) fmt::print("{}\n{}", folder.string(), summary.text(diagnostics));
  if (summary.frames() == 0) {
    throw InputError(fmt::format("{}: no image could be used; see the warnings above and {}", arguments.data,
                                 (folder / "run.json").string()));
  }
  if (summary.posed() == 0) {
    throw EstimationError(fmt::format("{}: no pose after {} frames; still waiting for {}", arguments.data,
                                      summary.frames(), summary.last().waiting_for));
  }
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
  command->add_flag("-q,--quiet", arguments->quiet, "no progress and no summary");
  command->footer(
      "Examples:\n"
      "  lodeline run dive1 -o dive1_result\n"
      "  lodeline run dive1 -o left_only --set source.cameras=[0]\n"
      "Results: trajectory.tum, states.csv, landmarks.ply, config.yaml (all settings in effect), run.json.");
  command->callback([arguments] { run(*arguments); });
}

}  // namespace lodeline
