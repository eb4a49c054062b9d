#include "apps/lodeline/allan_command.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "apps/lodeline/shared/bag_options.h"
#include "apps/lodeline/shared/common_options.h"
#include "lodeline/diagnostics.h"
#include "lodeline/output/report/findings.h"
#include "lodeline/output/report/noise_report.h"
#include "lodeline/pipeline/calibration/analyse_noise.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/json_text.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

struct AllanArguments {
  NoiseRequest request;
  std::string output;
  std::string json;
  RecordingPart part;
  Verbosity verbosity;
};

const SensorNoise* find(const std::vector<SensorNoise>& sensors, const AnalysedSensor& wanted) {
  for (const SensorNoise& noise : sensors) {
    if (noise.sensor.name == wanted.name) return &noise;
  }
  return nullptr;
}

void drawFigures(const std::vector<SensorNoise>& sensors, const std::filesystem::path& folder,
                 Diagnostics* diagnostics) {
  std::vector<gnuplot::Figure> figures;
  for (const SensorNoise& noise : sensors) figures.push_back(allanFigure(noise));
  const gnuplot::Result result = gnuplot::draw(figures, folder);
  if (result.outcome == gnuplot::Outcome::Drawn) return;
  const bool missing = result.outcome == gnuplot::Outcome::Missing;
  diagnostics->report(Severity::Warning, missing ? "gnuplot_missing" : "gnuplot_failed",
                      missing ? "no plots: the program gnuplot is not installed (Debian package gnuplot-nox)"
                              : "no plots: gnuplot failed: " + result.message);
}

void allan(AllanArguments arguments) {
  arguments.request.skip_s = arguments.part.from_s;
  arguments.request.duration_s = arguments.part.length_s().value_or(0.0);
  Diagnostics diagnostics;
  Progress progress("reading", arguments.verbosity.quiet);
  arguments.request.progress = progress.function();
  const std::vector<SensorNoise> sensors = analyseNoise(arguments.request, &diagnostics);
  progress.end();
  if (!arguments.output.empty()) {
    const std::filesystem::path folder = arguments.output;
    createOutputFolder(folder);
    const SensorNoise* gyroscope = find(sensors, gyroscopeToAnalyse());
    const SensorNoise* accelerometer = find(sensors, accelerometerToAnalyse());
    const SensorNoise* magnetometer = find(sensors, magnetometerToAnalyse());
    if (gyroscope && accelerometer)
      writeOutput(folder / "imu.yaml", kalibrImuYaml(*gyroscope, *accelerometer));
    if (magnetometer) writeOutput(folder / "magnetometer.yaml", magnetometerYaml(*magnetometer));
    drawFigures(sensors, folder, &diagnostics);
  }
  if (!arguments.json.empty()) {
    nlohmann::ordered_json json = noiseJson(sensors);
    json["findings"] = findingsJson(diagnostics);
    writeOutput(arguments.json, jsonText(json) + "\n");
  }
  if (!arguments.verbosity.quiet) fmt::print("{}", noiseTable(sensors));
  printFindings(diagnostics, arguments.verbosity);
}

}  // namespace

void addAllanCommand(CLI::App& program) {
  const auto arguments = std::make_shared<AllanArguments>();
  CLI::App* command = program.add_subcommand(
      "allan", "Noise of gyroscope, accelerometer and magnetometer from a record at rest");
  command
      ->add_option("DATA", arguments->request.data,
                   "EuRoC folder (mav0), ROS bag (.bag, .mcap, .db3, folder), film or sensor log (CSV, zip, "
                   "PX4, ArduPilot)")
      ->required();
  addBagOptions(&arguments->request.bag, command);
  command->add_option("-o,--output", arguments->output,
                      "folder for imu.yaml (Kalibr), magnetometer.yaml and plots");
  command->add_option("--json", arguments->json, "write all figures and curves to this file");
  addRecordingPart(&arguments->part, command);
  addVerbosity(&arguments->verbosity, command);
  command->footer(
      "The rig must lie still on solid ground, for hours. A CSV file has a header with units, such as\n"
      "`t [s], wx [rad/s], …, ax [m/s^2], …, mx [uT], …`, or a time with 3 (magnetometer), 6 (gyroscope,\n"
      "accelerometer) or 9 numbers.\n"
      "Examples:\n"
      "  lodeline allan bench -o bench_noise --json bench_noise/figures.json\n"
      "  lodeline allan rest.csv --from 600");
  command->callback([arguments] { allan(*arguments); });
}

}  // namespace lodeline
