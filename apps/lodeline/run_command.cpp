#include "apps/lodeline/run_command.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>

#include "apps/lodeline/shared/bag_options.h"
#include "apps/lodeline/shared/common_options.h"
#include "apps/lodeline/shared/interruption.h"
#include "lodeline/diagnostics.h"
#include "lodeline/output/report/page/page_template.h"
#include "lodeline/pipeline/run_outcome.h"
#include "lodeline/pipeline/run_recording.h"
#include "lodeline/pipeline/run_report.h"
#include "lodeline/util/terminal/terminal.h"

namespace lodeline {
namespace {

constexpr int kLivePort = 8642;

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
  if (!request.quiet) {
    fmt::print("{}\n{}", request.output,
               summary.text(diagnostics, request.verbose, terminal::width(stdout).value_or(0)));
  }
  if (with_report && summary.posed() > 0) {
    const std::string remark = writeRunReport(request);
    if (!request.quiet && !remark.empty()) fmt::print("  {:<20} {}\n", "report", remark);
  }
  if (summary.interrupted) throw Interruption(fmt::format("{} holds the results up to then", request.output));
  requireResult(request, summary, diagnostics);
}

void addRunOptions(RunArguments* arguments, CLI::App* command) {
  RunRequest* const request = &arguments->request;
  command
      ->add_option("DATA", request->data, "EuRoC folder (mav0), ROS bag (.bag, .mcap, .db3, folder) or film")
      ->required();
  command->add_option("-o,--output", request->output, "folder for the results; made where it is missing")
      ->required();
  command->add_option("-c,--config", request->config, "file of settings (YAML)");
  command->add_option("-s,--set", request->overrides, "one setting; goes over the file");
  command
      ->add_option("--draw-tracks", request->draw_tracks_s,
                   "write an image with tracks every so many seconds, to frames")
      ->type_name("SECONDS");
  command->add_option("--mag-calibration", request->magnetometer_calibration,
                      "what `lodeline calibrate magnetometer` wrote");
  command->add_option("--magnetometer", request->magnetometer,
                      "off, paper or absolute (default: absolute where it is calibrated)");
  addSite(&arguments->site, command);
  command->add_option("--map", request->map, "map of earlier dives, in which the run looks for its place");
  addStartOptions(&arguments->start, command)->needs("--map");
  command
      ->add_option(
          "--live", request->live_port,
          fmt::format("show the run in the browser, at this port ({} where none is named); 0 takes any port",
                      kLivePort))
      ->type_name("[PORT]")
      ->check(CLI::Range(0, 65535));
  command
      ->add_option("--live-address", request->live_address,
                   "network address for --live; 0.0.0.0 lets other machines see the page")
      ->capture_default_str();
  command->add_flag("--live-wait", request->live_wait, "begin when a browser has opened the page of --live")
      ->needs("--live");
  command
      ->add_option("--rate", request->rate, "read the recording at most so many times as fast as it was made")
      ->type_name("FACTOR")
      ->check(CLI::PositiveNumber);
  command->add_flag("--no-report", request->no_report, "do not write report.html and its images");
  addBagOptions(&request->bag, command);
  addRecordingPart(&arguments->part, command);
  addCameras(&arguments->cameras, command);
  addOverwrite(&request->overwrite, command);
  addVerbosity(&arguments->verbosity, command);
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
  const auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = program.add_subcommand("run", "Estimate a trajectory and a map from a recording");
  addRunOptions(arguments.get(), command);
  command->footer(
      "Examples:\n"
      "  lodeline run dive1 -o dive1_result\n"
      "  lodeline run dive1 -o left_only --cameras 0\n"
      "  lodeline run dive1 -o north --mag-calibration mag.yaml --site 29.83,-82.60,20 --date 2026-11-21\n"
      "  lodeline run dive1 -o dive1_result --draw-tracks 5\n"
      "  lodeline run dive1 -o dive1_result --live --live-wait --rate 1\n"
      "  lodeline run dive1.bag -o dive1_result --rig camchain-imucam.yaml --rig imu.yaml\n"
      "docs/reference/output-files.md describes the results.");
  command->callback([arguments] { executeRun(requestOf(*arguments)); });
}

}  // namespace lodeline
