#include "apps/lodeline/compare/compare_command.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "apps/lodeline/batch/batch_command.h"
#include "apps/lodeline/batch/batch_summary.h"
#include "apps/lodeline/batch/batch_worker.h"
#include "apps/lodeline/compare/compared_run.h"
#include "apps/lodeline/shared/bag_options.h"
#include "apps/lodeline/shared/common_options.h"
#include "apps/lodeline/shared/interruption.h"
#include "apps/lodeline/simulate/simulate_command.h"
#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/figures/comparison_report.h"
#include "lodeline/evaluation/figures/plots.h"
#include "lodeline/output/report/findings.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/json_text.h"
#include "lodeline/version.h"

namespace lodeline {
namespace {

const char* const kCompareFooter =
    R"(docs/how-to/compare-methods.md explains the methods. Given again, the command makes only what is missing.
Examples:
  lodeline compare demo --realism field -o demo_compared
  lodeline compare dive1 dive2 --methods off,absolute --runs 1 --mag-calibration mag.yaml -o compared
  lodeline compare cave1_short --realism field --cameras 0 -o left_camera)";

/// Length of the true path while images are used.
double pathBetween_m(Trajectory truth, Time begin, Time end) {
  std::erase_if(truth.poses, [&](const StampedPose& pose) { return pose.time < begin || pose.time > end; });
  return pathLength(truth);
}

/// Unique name for each recording: recordings of equal name in different folders would write to the same
/// folder.
std::string distinctName(const std::string& name, const std::vector<ComparisonInput>& others) {
  const auto isTaken = [&](const std::string& wanted) {
    return std::any_of(others.begin(), others.end(),
                       [&](const ComparisonInput& other) { return other.name == wanted; });
  };
  std::string distinct = name;
  for (int number = 2; isTaken(distinct); ++number) distinct = fmt::format("{}_{}", name, number);
  return distinct;
}

std::vector<ComparisonInput> prepareAll(const ComparisonRequest& request) {
  std::vector<ComparisonInput> inputs;
  for (const std::string& name : request.inputs) {
    ComparisonInput input;
    if (!prepareComparison(name, request, &input)) {
      throw Interruption("the same command goes on from there");
    }
    input.name = distinctName(input.name, inputs);
    inputs.push_back(std::move(input));
  }
  return inputs;
}

ComparedRecording judgeRecording(const ComparisonInput& input, const std::vector<std::string>& methods,
                                 const std::vector<BatchRow>& rows, const BatchFolder& folder) {
  ComparedRecording recording;
  recording.name = input.name;
  recording.extent =
      fmt::format("{}: {}, {:.1f} m, {} run{} a method", input.origin, input.extent,
                  pathBetween_m(input.truth, input.expected_stamps.front(), input.expected_stamps.back()),
                  input.seeds.size(), input.seeds.size() == 1 ? "" : "s");
  for (const std::string& method : methods) {
    recording.methods.push_back({method, {}});
    for (const ComparisonSeed& seed : input.seeds) {
      recording.methods.back().runs.push_back(judgeComparedRun(input, seed, method, rows, folder));
    }
  }
  return recording;
}

void writeResults(const std::vector<ComparedRecording>& recordings, const ComparisonRequest& request) {
  Diagnostics diagnostics;
  std::vector<gnuplot::Figure> figures;
  nlohmann::ordered_json json;
  json["program"] = fmt::format("lodeline {}", LODELINE_VERSION);
  std::string markdown;
  for (const ComparedRecording& recording : recordings) {
    for (gnuplot::Figure figure : {trajectoriesFigure(recording), relativeYawFigure(recording)}) {
      if (!figure.commands.empty()) figures.push_back(std::move(figure));
    }
    json["recordings"].push_back(comparisonJson(recording));
    markdown += (markdown.empty() ? "" : "\n") + comparisonMarkdown(recording);
    fmt::print("{}\n", comparisonTable(recording));
  }
  drawFigures(figures, request.output / "plots", diagnostics);
  json["findings"] = findingsJson(diagnostics);
  writeOutput(request.output / "compare.json", jsonText(json) + "\n");
  writeOutput(request.output / "compare.md", markdown);
  printFindings(diagnostics, request.arguments.verbosity);
}

bool hasTrajectory(const ComparedRecording& recording) {
  return std::any_of(recording.methods.begin(), recording.methods.end(),
                     [](const ComparedMethod& method) { return meansOf(method).runs > 0; });
}

void checkRequest(const ComparisonRequest& request) {
  if (request.methods.empty())
    throw UsageError("--methods: name at least one of off, paper, absolute, azimuth");
  for (const std::string& method : request.methods) {
    if (!isComparedMethod(method)) {
      throw UsageError(
          fmt::format("--methods {}: no such method; there are off, paper, absolute and azimuth", method));
    }
  }
  static_cast<void>(request.arguments.site.field_ENU());
}

void compare(ComparisonRequest request) {
  checkRequest(request);
  request.run = requestOf(request.arguments);
  request.work.quiet = request.run.quiet;
  const std::vector<ComparisonInput> inputs = prepareAll(request);
  const BatchFolder folder(request.output);
  const BatchList list = comparedRuns(inputs, request.methods);
  workOnBatch(list, folder, request.work);
  const std::vector<BatchRow> rows = batchRows(list, folder, {});
  std::vector<ComparedRecording> recordings;
  for (const ComparisonInput& input : inputs) {
    recordings.push_back(judgeRecording(input, request.methods, rows, folder));
  }
  writeResults(recordings, request);
  for (const ComparedRecording& recording : recordings) {
    if (!hasTrajectory(recording)) {
      throw EstimationError(recording.name + ": no run gave a trajectory; the table says why");
    }
  }
}

void addSharedRunOptions(CLI::App* command, RunArguments* arguments) {
  RunRequest& run = arguments->request;
  command->add_option("-c,--config", run.config, "file of settings of all runs (YAML)");
  command->add_option("-s,--set", run.overrides, "one setting of all runs");
  command->add_option("--mag-calibration", run.magnetometer_calibration,
                      "what `lodeline calibrate magnetometer` wrote; scenarios calibrate their own rig");
  addSite(&arguments->site, command);
  addCameras(&arguments->cameras, command);
  addVerbosity(&arguments->verbosity, command);
}

}  // namespace

void addCompareCommand(CLI::App& program) {
  const auto request = std::make_shared<ComparisonRequest>();
  request->methods = {"off", "paper", "absolute", "azimuth"};
  CLI::App* command = program.add_subcommand(
      "compare", "Compare methods of using the magnetometer on recordings with ground truth");
  command
      ->add_option("DATA|SCENARIO", request->inputs,
                   "EuRoC folders or ROS bags with ground truth, or scenarios of `lodeline simulate`")
      ->required();
  command->add_option("-o,--output", request->output, "folder for the results; made where it is missing")
      ->required();
  command->add_option("--methods", request->methods, "methods, with commas")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--runs", request->runs, "number of runs of each method")
      ->check(CLI::Range(1, 99))
      ->capture_default_str();
  addBatchRunOptions(&request->work, command);
  addSharedRunOptions(command, &request->arguments);
  addBagOptions(&request->arguments.request.bag, command);
  addRecordingPart(&request->arguments.part, command);
  command->add_option("--recordings", request->recordings,
                      "folder of simulated recordings, NAME_REALISM each (default: OUT/recordings)");
  command->add_flag("!--no-rendering", request->render,
                    "render no images; of an unfinished simulated recording, take the part there is");
  command->add_option("--threads", request->threads, "number of threads for rendering (default: all cores)");
  addScenarioOptions(command, &request->changes);
  command->footer(kCompareFooter);
  command->callback([request] { compare(*request); });
}

}  // namespace lodeline
