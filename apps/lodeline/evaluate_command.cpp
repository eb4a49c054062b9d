#include "apps/lodeline/evaluate_command.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

#include "apps/lodeline/evaluation_page.h"
#include "apps/lodeline/shared/common_options.h"
#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/figures/evaluation_report.h"
#include "lodeline/evaluation/figures/plots.h"
#include "lodeline/evaluation/figures/several_estimates.h"
#include "lodeline/evaluation/trajectory/image_times.h"
#include "lodeline/evaluation/trajectory/read_body_from_camera.h"
#include "lodeline/output/report/read_reported_uncertainty.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/json_text.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

const char* const kEvaluateFooter = R"(Examples:
  lodeline evaluate OUT mav0/state_groundtruth_estimate0/data.csv --images mav0/cam0
      a run of `lodeline run` against EuRoC truth, SE(3) alignment, completion by left images
  lodeline evaluate OUT truth.tum --align yaw --plots plots --json figures.json
      visual-inertial odometry: align position and yaw only, draw pictures, keep the figures
  lodeline evaluate OUT model/images.bin --align sim3 --image-times mav0/cam0/data.csv
      against a COLMAP model, which is known up to scale
  lodeline evaluate ours okvis2.txt openvins.txt truth.tum --plots plots --html comparison.html
      several estimates in one table, with plots and a page that show all of them
  lodeline evaluate KITTI_00_ORB.txt KITTI_00_gt.txt --stretches-m 100,200,300,400

--from and --to count from the first pose of the estimates. The reported uncertainty is checked for all poses.
docs/reference/error-measures.md defines every figure.)";

struct Arguments {
  std::vector<std::string> trajectories;  ///< estimates, and the reference as the last one
  std::string estimate_format;
  std::string reference_format;
  std::string image_times;
  std::string body_from_camera;
  std::string align = "se3";
  bool interpolate = false;
  std::string images;
  std::string json;
  std::string plots;
  std::string html;
  EvaluationOptions options;
  RecordingPart part;
  Verbosity verbosity;

  const std::string& reference() const { return trajectories.back(); }
  std::vector<std::string> estimates() const { return {trajectories.begin(), trajectories.end() - 1}; }
};

TrajectoryReadOptions readOptions(const Arguments& arguments, const std::string& format) {
  TrajectoryReadOptions options;
  if (!format.empty()) options.format = trajectoryFormatFromString(format);
  if (!arguments.image_times.empty()) options.image_times = arguments.image_times;
  if (!arguments.body_from_camera.empty()) {
    options.body_from_camera = readBodyFromCamera(arguments.body_from_camera);
  }
  return options;
}

bool isColmap(const std::string& path, const TrajectoryReadOptions& options) {
  const TrajectoryFormat format = findTrajectory(path, options.format).format;
  return format == TrajectoryFormat::ColmapText || format == TrajectoryFormat::ColmapBinary;
}

void writeJson(const std::filesystem::path& path, const nlohmann::ordered_json& json) {
  std::ofstream file(path);
  file << jsonText(json) << "\n";
  file.close();
  if (!file)
    throw InputError(fmt::format("{}: cannot be written; check the folder and its rights", path.string()));
}

/// Names of the estimates: the last parts of their paths, as many as tell them apart.
std::vector<std::string> namesOf(const std::vector<std::string>& estimates) {
  std::vector<std::string> names;
  for (const std::string& path : estimates) {
    const std::filesystem::path whole = std::filesystem::absolute(path).lexically_normal();
    std::filesystem::path rest = whole.has_filename() ? whole : whole.parent_path();
    std::string name = rest.stem().string();
    while (std::find(names.begin(), names.end(), name) != names.end() && rest.has_relative_path()) {
      rest = rest.parent_path();
      name = fmt::format("{}_{}", rest.filename().string(), name);
    }
    names.push_back(name);
  }
  return names;
}

EvaluationOptions optionsOf(const Arguments& arguments) {
  EvaluationOptions options = arguments.options;
  options.alignment = alignmentTypeFromString(arguments.align);
  if (arguments.interpolate) options.association.method = AssociationMethod::Interpolate;
  if (!arguments.images.empty()) options.expected_stamps = readImageStamps(arguments.images);
  return options;
}

void refuseColmapOptions(const Arguments& arguments, const TrajectoryReadOptions& estimate_options,
                         const TrajectoryReadOptions& reference_options) {
  if (arguments.body_from_camera.empty() && arguments.image_times.empty()) return;
  bool is_any = isColmap(arguments.reference(), reference_options);
  for (const std::string& path : arguments.estimates()) is_any = is_any || isColmap(path, estimate_options);
  if (is_any) return;
  throw UsageError("--body-from-camera and --image-times are for COLMAP models; no trajectory is one");
}

void writePage(const Arguments& arguments, const std::vector<NamedEvaluation>& estimates,
               const ShareDone& progress, Diagnostics* diagnostics) {
  std::vector<PageEstimate> shown;
  for (size_t i = 0; i < estimates.size(); ++i)
    shown.push_back({arguments.trajectories[i], estimates[i].name, &estimates[i].evaluation.estimate});
  const ReportReference reference = {arguments.reference(), alignmentTypeFromString(arguments.align)};
  writeOutput(arguments.html, evaluationPage(shown, reference, progress, diagnostics));
}

void writeAllPlots(const std::vector<NamedEvaluation>& estimates, const std::filesystem::path& folder,
                   const ShareDone& progress, Diagnostics* diagnostics) {
  const bool is_one = estimates.size() == 1;
  if (!is_one)
    drawFigures({severalErrorsFigure(estimates), severalPathsFigure(estimates)}, folder, *diagnostics);
  double done = is_one ? 0.0 : 1.0;
  const double total = done + static_cast<double>(estimates.size());
  progress(done / total);
  for (const auto& [name, evaluation] : estimates) {
    writePlots(evaluation, is_one ? folder : folder / name, *diagnostics);
    progress(++done / total);
  }
}

nlohmann::ordered_json jsonOf(const std::vector<NamedEvaluation>& estimates,
                              const std::vector<Diagnostics>& findings) {
  if (estimates.size() == 1) return evaluationJson(estimates.front().evaluation, findings.front());
  nlohmann::ordered_json json;
  for (size_t i = 0; i < estimates.size(); ++i)
    json["estimates"][estimates[i].name] = evaluationJson(estimates[i].evaluation, findings[i]);
  return json;
}

/// Keeps the poses of a part of all estimates, in seconds from their first pose. Throws InputError where an
/// estimate has none there.
void keepPart(const RecordingPart& part, const std::vector<std::string>& paths,
              std::vector<Trajectory>* estimates) {
  if (part.isAll()) return;
  const double length_s = part.length_s().value_or(HUGE_VAL);
  std::optional<Time> start;
  for (const Trajectory& estimate : *estimates) {
    if (!estimate.poses.empty())
      start = std::min(start.value_or(estimate.poses.front().time), estimate.poses.front().time);
  }
  for (size_t i = 0; i < estimates->size(); ++i) {
    std::vector<StampedPose>& poses = (*estimates)[i].poses;
    std::erase_if(poses, [&](const StampedPose& pose) {
      const double since_s = (pose.time - *start).seconds();
      return since_s < part.from_s || since_s > part.from_s + length_s;
    });
    if (poses.empty())
      throw InputError(fmt::format("{}: has no pose in the part that --from and --to choose", paths[i]));
  }
}

void evaluateCommand(const Arguments& arguments) {
  const EvaluationOptions options = optionsOf(arguments);
  const TrajectoryReadOptions estimate_options = readOptions(arguments, arguments.estimate_format);
  const TrajectoryReadOptions reference_options = readOptions(arguments, arguments.reference_format);
  refuseColmapOptions(arguments, estimate_options, reference_options);
  const std::vector<std::string> paths = arguments.estimates();
  const std::vector<std::string> names = namesOf(paths);
  std::vector<Diagnostics> findings(paths.size());
  std::vector<NamedEvaluation> estimates;
  std::vector<Trajectory> trajectories;
  Progress progress("evaluation", arguments.verbosity.quiet);
  int steps = 0;  // for each estimate: read it, read the reference, compare, check the claims
  const auto addStep = [&] { progress.show(++steps / (4.0 * static_cast<double>(paths.size()))); };
  for (size_t i = 0; i < paths.size(); ++i) {
    trajectories.push_back(readTrajectory(paths[i], estimate_options, findings[i]));
    addStep();
  }
  keepPart(arguments.part, paths, &trajectories);
  for (size_t i = 0; i < paths.size(); ++i) {
    const Trajectory reference = readTrajectory(arguments.reference(), reference_options, findings[i]);
    addStep();
    estimates.push_back({names[i], evaluate(trajectories[i], reference, options, findings[i])});
    addStep();
    estimates.back().evaluation.claims =
        checkReported(paths[i], reference, options.association, &findings[i]);
    addStep();
  }
  Diagnostics of_output;
  if (!arguments.plots.empty()) {
    progress.begin("plots");
    writeAllPlots(estimates, arguments.plots, progress.function(), &of_output);
  }
  if (!arguments.html.empty()) {
    progress.begin("page");
    writePage(arguments, estimates, progress.function(), &of_output);
  }
  progress.end();
  if (!arguments.json.empty()) writeJson(arguments.json, jsonOf(estimates, findings));
  if (!arguments.verbosity.quiet) {
    fmt::print("{}", estimates.size() == 1 ? evaluationTable(estimates.front().evaluation)
                                           : severalTable(estimates));
  }
  for (size_t i = 0; i < paths.size(); ++i) {
    if (paths.size() > 1 && !findings[i].ranked().empty()) fmt::print("{}:\n", names[i]);
    printFindings(findings[i], arguments.verbosity);
  }
  printFindings(of_output, arguments.verbosity);
}

void addReadOptions(CLI::App& command, Arguments& arguments) {
  constexpr int kMostTrajectories = 1000;
  command
      .add_option("TRAJECTORY", arguments.trajectories,
                  "files or folders: one or more estimates, and the reference as the last one")
      ->required()
      ->expected(2, kMostTrajectories);
  command.add_option("--format", arguments.estimate_format,
                     "layout of the estimate: tum, kitti, euroc, colmap-text, colmap-binary");
  command.add_option("--reference-format", arguments.reference_format, "layout of the reference");
  command.add_option("--image-times", arguments.image_times,
                     "times of COLMAP images: lines `name time[s]`, or data.csv of an EuRoC camera");
  command.add_option("--body-from-camera", arguments.body_from_camera,
                     "sensor.yaml of the camera of COLMAP, whose T_BS turns its poses into body poses");
}

void addComparisonOptions(CLI::App& command, Arguments& arguments) {
  EvaluationOptions& options = arguments.options;
  command.add_option("--align", arguments.align, "none, yaw, se3 or sim3")->capture_default_str();
  command
      .add_option("--align-pairs", options.alignment_pairs,
                  "number of the first pairs to align on; 0 takes all")
      ->capture_default_str();
  command
      .add_option("--time-offset-s", options.association.time_offset_s,
                  "seconds to add to the times of the estimate")
      ->capture_default_str();
  command
      .add_option("--time-tolerance-s", options.association.tolerance_s,
                  "largest difference of times in a pair")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_flag("--interpolate", arguments.interpolate,
                   "interpolate the reference at the times of the estimate");
  command
      .add_option("--stretches-m", options.stretch_lengths_m,
                  "lengths for relative errors, with commas (default: 10 to 50 % of the path)")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  command.add_option("--consecutive-m", options.consecutive_length_m, "length of the consecutive stretches")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.add_option(
      "--images", arguments.images,
      "data.csv or folder of an EuRoC camera; completion is the share of its images with a pose");
}

}  // namespace

void addEvaluateCommand(CLI::App& program) {
  CLI::App* command = program.add_subcommand("evaluate", "Compare an estimated trajectory with a reference");
  const auto arguments = std::make_shared<Arguments>();
  addReadOptions(*command, *arguments);
  addComparisonOptions(*command, *arguments);
  command->add_option("--json", arguments->json, "write all figures to this file");
  command->add_option("--plots", arguments->plots,
                      "write plots as SVG and PNG to this folder (needs gnuplot)");
  command->add_option("--html", arguments->html, "write a page for the browser, with paths coloured by error")
      ->type_name("FILE");
  addRecordingPart(&arguments->part, command);
  addVerbosity(&arguments->verbosity, command);
  command->footer(kEvaluateFooter);
  command->callback([arguments] { evaluateCommand(*arguments); });
}

}  // namespace lodeline
