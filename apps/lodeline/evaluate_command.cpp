#include "apps/lodeline/evaluate_command.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <memory>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/figures/evaluation_report.h"
#include "lodeline/evaluation/figures/plots.h"
#include "lodeline/evaluation/trajectory/image_times.h"
#include "lodeline/evaluation/trajectory/read_body_from_camera.h"
#include "lodeline/output/report/read_reported_uncertainty.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/json_text.h"

namespace lodeline {
namespace {

const char* const kEvaluateFooter = R"(Examples:
  lodeline evaluate OUT mav0/state_groundtruth_estimate0/data.csv --images mav0/cam0
      a run of `lodeline run` against EuRoC truth, SE(3) alignment, completion by left images
  lodeline evaluate OUT truth.tum --align yaw --plots plots --json figures.json
      visual-inertial odometry: align position and yaw only, draw pictures, keep the figures
  lodeline evaluate OUT model/images.bin --align sim3 --image-times mav0/cam0/data.csv
      against a COLMAP model, which is known up to scale
  lodeline evaluate KITTI_00_ORB.txt KITTI_00_gt.txt --stretches-m 100,200,300,400

Layouts (found by themselves, or named with --format): TUM, KITTI, EuRoC ground truth, COLMAP images.txt and
images.bin, the output folder of `lodeline run`; text files may be compressed with gzip. docs/reference/error-measures.md
defines every figure.)";

struct Arguments {
  std::string estimate;
  std::string reference;
  std::string estimate_format;
  std::string reference_format;
  std::string image_times;
  std::string body_from_camera;
  std::string align = "se3";
  bool interpolate = false;
  std::string images;
  std::string json;
  std::string plots;
  EvaluationOptions options;
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

void evaluateCommand(const Arguments& arguments) {
  Diagnostics diagnostics;
  EvaluationOptions options = arguments.options;
  options.alignment = alignmentTypeFromString(arguments.align);
  if (arguments.interpolate) options.association.method = AssociationMethod::Interpolate;
  if (!arguments.images.empty()) options.expected_stamps = readImageStamps(arguments.images);
  const auto estimate_options = readOptions(arguments, arguments.estimate_format);
  const auto reference_options = readOptions(arguments, arguments.reference_format);
  const bool for_colmap = !arguments.body_from_camera.empty() || !arguments.image_times.empty();
  if (for_colmap && !isColmap(arguments.estimate, estimate_options) &&
      !isColmap(arguments.reference, reference_options)) {
    throw UsageError("--body-from-camera and --image-times are for COLMAP models; neither trajectory is one");
  }
  const Trajectory estimate = readTrajectory(arguments.estimate, estimate_options, diagnostics);
  const Trajectory reference = readTrajectory(arguments.reference, reference_options, diagnostics);

  Evaluation evaluation = evaluate(estimate, reference, options, diagnostics);
  evaluation.claims = checkReported(arguments.estimate, reference, options.association, &diagnostics);
  if (!arguments.plots.empty()) writePlots(evaluation, arguments.plots, diagnostics);
  if (!arguments.json.empty()) writeJson(arguments.json, evaluationJson(evaluation, diagnostics));
  fmt::print("{}", evaluationTable(evaluation, diagnostics));
}

void addReadOptions(CLI::App& command, Arguments& arguments) {
  command.add_option("ESTIMATE", arguments.estimate, "Trajectory to judge: file or folder")->required();
  command.add_option("REFERENCE", arguments.reference, "Trajectory taken as true: file or folder")
      ->required();
  command.add_option("--format", arguments.estimate_format,
                     "Layout of the estimate: tum, kitti, euroc, colmap-text, colmap-binary");
  command.add_option("--reference-format", arguments.reference_format, "Layout of the reference");
  command.add_option("--image-times", arguments.image_times,
                     "Times of COLMAP images: lines `name time[s]`, or a EuRoC camera's data.csv");
  command.add_option(
      "--body-from-camera", arguments.body_from_camera,
      "sensor.yaml of the camera COLMAP was run on (its T_BS): turns its poses into body poses");
}

void addComparisonOptions(CLI::App& command, Arguments& arguments) {
  EvaluationOptions& options = arguments.options;
  command.add_option("--align", arguments.align, "none, yaw, se3 or sim3")->capture_default_str();
  command
      .add_option("--align-pairs", options.alignment_pairs, "Align on the first so many pairs only; 0: all")
      ->capture_default_str();
  command.add_option("--time-offset-s", options.association.time_offset_s, "Added to the estimate's times")
      ->capture_default_str();
  command
      .add_option("--time-tolerance-s", options.association.tolerance_s,
                  "Largest difference of times in a pair")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command.add_flag("--interpolate", arguments.interpolate,
                   "Interpolate the reference to the estimate's times instead of taking the nearest pose");
  command
      .add_option("--stretches-m", options.stretch_lengths_m,
                  "Lengths for relative errors, comma-separated; default 10 to 50 % of the path")
      ->delimiter(',')
      ->check(CLI::PositiveNumber);
  command.add_option("--consecutive-m", options.consecutive_length_m, "Length of the consecutive stretches")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command.add_option(
      "--images", arguments.images,
      "A EuRoC camera's data.csv or folder: completion is the share of its images with a pose");
}

}  // namespace

void addEvaluateCommand(CLI::App& program) {
  CLI::App* command = program.add_subcommand("evaluate", "Compare an estimated trajectory with a reference");
  const auto arguments = std::make_shared<Arguments>();
  addReadOptions(*command, *arguments);
  addComparisonOptions(*command, *arguments);
  command->add_option("--json", arguments->json, "Write all figures to this file");
  command->add_option("--plots", arguments->plots,
                      "Write plots as SVG and PNG to this folder (needs gnuplot)");
  command->footer(kEvaluateFooter);
  command->callback([arguments] { evaluateCommand(*arguments); });
}

}  // namespace lodeline
