#include "apps/lodeline/calibrate_cameras_command.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>

#include "apps/lodeline/shared/bag_options.h"
#include "apps/lodeline/shared/common_options.h"
#include "lodeline/cameras/camera_model.h"
#include "lodeline/pipeline/calibration/calibrate_cameras.h"
#include "lodeline/pipeline/open_recording.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

const char* const kFooter =
    R"(Images of one camera are enough. Inertial readings also give the pose on the IMU and the delay.
docs/how-to/calibrate-cameras.md explains the board, a grid of AprilTags (36h11), and how to move the rig.
Examples, the port under water with a lens from air:
  lodeline calibrate cameras air -o lens --board board.yaml
  lodeline calibrate cameras water -o rig --board board.yaml --rig lens/rig.yaml --keep lens \
    --port flat)";

struct CamerasArguments {
  std::string data;
  BagArguments bag;
  std::string output;
  std::string board;
  std::vector<int> cameras;
  std::string model;
  std::string port;
  std::vector<std::string> keep;
  bool without_imu = false;
  Verbosity verbosity;
  double rate_hz = 10.0;
  double most_delay_s = 0.15;
  RecordingPart part;
};

std::filesystem::path boardFile(const CamerasArguments& arguments) {
  if (!arguments.board.empty()) return arguments.board;
  const std::filesystem::path beside = std::filesystem::path(arguments.data) / "board.yaml";
  std::error_code ignored;
  if (std::filesystem::exists(beside, ignored)) return beside;
  throw UsageError("name the file of the board with --board; there is no board.yaml in " + arguments.data);
}

std::optional<Port> startPort(const std::string& name) {
  if (name.empty() || name == "none") return std::nullopt;
  Port port;
  port.thickness_m = 0.008;
  if (name == "flat") {
    port.distance_m = 0.015;
  } else {
    port.type = Port::Type::Dome;
    port.radius_m = 0.05;
  }
  return port;
}

CameraCalibrationRequest requestOf(const CamerasArguments& arguments) {
  if (!arguments.model.empty() && findCameraModel(arguments.model) == nullptr) {
    throw UsageError(fmt::format("--camera-model: there is no model '{}'; there are {}", arguments.model,
                                 cameraModelNames()));
  }
  CameraCalibrationRequest request;
  request.board = readBoard(boardFile(arguments));
  request.record.most_rate_hz = arguments.rate_hz;
  request.record.from_s = arguments.part.from_s;
  request.record.to_s = arguments.part.to_s;
  request.without_ports = arguments.port == "none";
  request.options.model = arguments.model;
  request.options.port = startPort(arguments.port);
  request.options.uses_imu = !arguments.without_imu;
  request.options.most_delay_s = arguments.most_delay_s;
  const auto keeps = [&](const char* what) {
    return std::find(arguments.keep.begin(), arguments.keep.end(), what) != arguments.keep.end();
  };
  request.options.keeps_lens = keeps("lens");
  request.options.keeps_port = keeps("port");
  return request;
}

void calibrateCameras(const CamerasArguments& arguments) {
  CameraCalibrationRequest request = requestOf(arguments);
  EurocOptions options;
  options.camera_indices = arguments.cameras;
  options.needs_imu = false;
  options.needs_calibration = false;
  Diagnostics diagnostics;
  const std::unique_ptr<RecordedSource> source =
      openRecording(arguments.data, options, arguments.bag, &diagnostics);
  Progress progress("searching for the board", arguments.verbosity.quiet);
  request.record.progress = [&](size_t images) {
    progress.show(source->shareRead(), fmt::format("{} images", images));
  };
  request.options.progress = [&](double share) {
    progress.begin("solving");
    progress.show(share);
  };
  CameraCalibrationOutcome outcome;
  try {
    outcome = calibrateCameras(source.get(), request, arguments.output, &diagnostics);
  } catch (const EstimationError&) {
    progress.end();
    printFindings(diagnostics, arguments.verbosity);
    throw;
  }
  progress.end();
  if (!arguments.verbosity.quiet) fmt::print("{}", outcome.text);
  printFindings(diagnostics, arguments.verbosity);
  if (!outcome.poor_because.empty())
    throw EstimationError(fmt::format("the calibration is poor: {}. The files are in {}",
                                      outcome.poor_because, arguments.output));
}

void addSelection(CamerasArguments* arguments, CLI::App* command) {
  addCameras(&arguments->cameras, command);
  addRecordingPart(&arguments->part, command);
  command
      ->add_option("--rate-hz", arguments->rate_hz,
                   "largest number of images per second and camera to use (default: 10)")
      ->check(CLI::PositiveNumber);
}

}  // namespace

void addCalibrateCamerasCommand(CLI::App& calibrate_command) {
  const auto arguments = std::make_shared<CamerasArguments>();
  CLI::App* command = calibrate_command.add_subcommand(
      "cameras", "Lenses, ports, poses and delay of cameras from a board, with uncertainties and a verdict");
  command
      ->add_option("DATA", arguments->data,
                   "EuRoC folder (mav0), ROS bag (.bag, .mcap, .db3, folder) or film")
      ->required();
  command
      ->add_option("-o,--output", arguments->output,
                   "folder for rig.yaml (for --rig), camchain-imucam.yaml (Kalibr), calibration.json, "
                   "reports and figures")
      ->required();
  addBagOptions(&arguments->bag, command);
  command->add_option("--board", arguments->board, "board in Kalibr's format (default: board.yaml in DATA)");
  addSelection(arguments.get(), command);
  command->add_option(
      "--camera-model", arguments->model,
      "lens of all cameras: " + cameraModelNames() + " (default: the stated one, else radial-tangential)");
  command
      ->add_option("--port", arguments->port,
                   "flat or dome: estimate such a port where the rig states none; none: ignore stated ports")
      ->check(CLI::IsMember({"flat", "dome", "none"}));
  command->add_option("--keep", arguments->keep, "stated values to keep: lens, port")
      ->delimiter(',')
      ->check(CLI::IsMember({"lens", "port"}));
  command->add_flag("--no-imu", arguments->without_imu, "calibrate the cameras alone");
  command
      ->add_option("--max-delay", arguments->most_delay_s,
                   "largest delay between images and IMU to look for, s (default: 0.15)")
      ->check(CLI::PositiveNumber);
  addVerbosity(&arguments->verbosity, command);
  command->footer(kFooter);
  command->callback([arguments] { calibrateCameras(*arguments); });
}

}  // namespace lodeline
