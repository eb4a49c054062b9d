#include "apps/lodeline/run_command.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>

#include "apps/lodeline/shared/bag_options.h"
#include "apps/lodeline/shared/interruption.h"
#include "lodeline/diagnostics.h"
#include "lodeline/output/report/page/page_template.h"
#include "lodeline/pipeline/run_outcome.h"
#include "lodeline/pipeline/run_recording.h"
#include "lodeline/pipeline/run_report.h"

namespace lodeline {
namespace {

constexpr int kLivePort = 8642;
constexpr size_t kTerminalWidth = 96;  ///< width of the values in the summary

bool isPort(const std::string& text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c); });
}

}  // namespace

void executeRun(RunRequest request) {
  const bool with_report = !request.no_report;
  request.sample_pictures = with_report && !pageTemplate().empty();
  Diagnostics diagnostics;
  const RunSummary summary = runRecording(request, &diagnostics);
  if (!request.quiet)
    fmt::print("{}\n{}", request.output,
               summary.text(diagnostics, request.verbose, isatty(STDOUT_FILENO) ? kTerminalWidth : 0));
  if (with_report && summary.posed() > 0) {
    const std::string remark = writeRunReport(request);
    if (!request.quiet && !remark.empty()) fmt::print("  {:<20} {}\n", "report", remark);
  }
  if (summary.interrupted) throw Interruption(fmt::format("{} holds the results up to then", request.output));
  requireResult(request, summary, diagnostics);
}

void addRunOptions(RunRequest* arguments, CLI::App* command) {
  command
      ->add_option("DATA", arguments->data,
                   "folder that contains mav0 (EuRoC ASL layout), or mav0 itself; or a ROS bag (.bag, .mcap, "
                   ".db3, folder)")
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
  command->add_option("--map", arguments->map,
                      "map of earlier dives (`lodeline map`): find the dive's place in it");
  command
      ->add_option("--live", arguments->live_port,
                   fmt::format("show the run in the browser while it goes on, at this port ({} where none is "
                               "named); 0 for any",
                               kLivePort))
      ->type_name("[PORT]")
      ->check(CLI::Range(0, 65535));
  command
      ->add_option("--live-address", arguments->live_address,
                   "network address for --live; 0.0.0.0 lets other machines see it")
      ->capture_default_str();
  command
      ->add_flag("--live-wait", arguments->live_wait, "with --live: begin when a browser has opened the page")
      ->needs("--live");
  command
      ->add_option("--rate", arguments->rate,
                   "read the recording at most so many times as fast as it was made; 1 plays it")
      ->type_name("FACTOR")
      ->check(CLI::PositiveNumber);
  command->add_flag("--no-report", arguments->no_report, "leave out report.html and its pictures");
  addBagOptions(&arguments->bag, command);
  command->add_flag("--overwrite", arguments->overwrite,
                    "replace the results of another run in the output folder");
  command->add_flag("-v,--verbose", arguments->verbose, "a summary with all figures");
  command->add_flag("-q,--quiet", arguments->quiet, "no progress and no summary");
}

std::vector<std::string> completeLiveOption(std::vector<std::string> arguments) {
  for (size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] != "--live") continue;
    const bool has_port = i + 1 < arguments.size() && isPort(arguments[i + 1]);
    arguments[i] = fmt::format("--live={}", has_port ? arguments[i + 1] : std::to_string(kLivePort));
    if (has_port) arguments.erase(arguments.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }
  return arguments;
}

void addRunCommand(CLI::App& program) {
  auto arguments = std::make_shared<RunRequest>();
  CLI::App* command = program.add_subcommand("run", "Estimate a trajectory and a map from a recording");
  addRunOptions(arguments.get(), command);
  command->footer(
      "Examples:\n"
      "  lodeline run dive1 -o dive1_result\n"
      "  lodeline run dive1 -o left_only --set source.cameras=[0]\n"
      "  lodeline run dive1 -o north --mag-calibration mag.yaml --site 29.83,-82.60,20 --date 2026-11-21\n"
      "  lodeline run dive1 -o dive1_result --draw-tracks 5\n"
      "  lodeline run dive1 -o dive1_result --live --live-wait --rate 1\n"
      "  lodeline run dive1.bag -o dive1_result --rig camchain-imucam.yaml --rig imu.yaml\n"
      "Results: trajectory.tum, states.csv, landmarks.ply, config.yaml (all settings in effect), run.json,\n"
      "report.html (all of it to look at); pictures of tracks in frames.");
  command->callback([arguments] { executeRun(*arguments); });
}

}  // namespace lodeline
