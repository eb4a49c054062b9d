#include "apps/lodeline/allan_command.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "apps/lodeline/shared/bag_options.h"
#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/csv_reader.h"
#include "lodeline/io/euroc/euroc_rig.h"
#include "lodeline/io/logs/open_sensor_log.h"
#include "lodeline/output/report/findings.h"
#include "lodeline/output/report/noise_report.h"
#include "lodeline/pipeline/open_recording.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/json_text.h"

namespace lodeline {
namespace {

struct AllanArguments {
  std::string data;
  BagArguments bag;
  std::string output;
  std::string json;
  double skip_s = 0.0;
  double duration_s = 0.0;
};

/// The part of the record to be analysed, counted from its first reading.
class Part {
 public:
  explicit Part(const AllanArguments& arguments) : arguments_(arguments) {}
  bool holds(Time time) {
    if (!first_) first_ = time;
    const double t = (time - *first_).seconds();
    return t >= arguments_.skip_s &&
           (arguments_.duration_s == 0.0 || t <= arguments_.skip_s + arguments_.duration_s);
  }

 private:
  const AllanArguments& arguments_;
  std::optional<Time> first_;
};

/// Analyses of the available ones of the three sensors.
class Analyses {
 public:
  explicit Analyses(Diagnostics* diagnostics)
      : gyroscope(gyroscopeToAnalyse(), diagnostics),
        accelerometer(accelerometerToAnalyse(), diagnostics),
        magnetometer(magnetometerToAnalyse(), diagnostics) {}

  SensorNoiseAnalysis gyroscope, accelerometer, magnetometer;
  bool has_gyroscope = false, has_accelerometer = false, has_magnetometer = false;

  std::vector<SensorNoise> finish() {
    std::vector<SensorNoise> sensors;
    if (has_gyroscope) sensors.push_back(gyroscope.finish());
    if (has_accelerometer) sensors.push_back(accelerometer.finish());
    if (has_magnetometer) sensors.push_back(magnetometer.finish());
    return sensors;
  }
};

void readFolder(const AllanArguments& arguments, Diagnostics* diagnostics, Analyses* analyses) {
  EurocOptions options;
  options.with_cameras = false;
  options.needs_imu = false;
  const EurocLayout layout = findEurocLayout(arguments.data, options);
  CsvRow row;
  if (layout.has_imu) {
    analyses->has_gyroscope = analyses->has_accelerometer = true;
    CsvReader imu(layout.csv("imu0"), CsvContent::Imu, diagnostics, kInertialRate);
    for (Part part(arguments); imu.next(&row);) {
      if (!part.holds(row.time)) continue;
      analyses->gyroscope.add(row.time, Vec3(row.numbers.data()));
      analyses->accelerometer.add(row.time, Vec3(row.numbers.data() + 3));
    }
  }
  if (!std::filesystem::exists(layout.csv("mag0"))) return;
  analyses->has_magnetometer = true;
  CsvReader magnetometer(layout.csv("mag0"), CsvContent::Magnetometer, diagnostics, kMagnetometerRate);
  for (Part part(arguments); magnetometer.next(&row);) {
    if (part.holds(row.time)) analyses->magnetometer.add(row.time, Vec3(row.numbers.data()));
  }
}

void readRecording(const AllanArguments& arguments, Diagnostics* diagnostics, Analyses* analyses) {
  const std::unique_ptr<RecordedSource> bag = openReadings(arguments.data, arguments.bag, diagnostics).source;
  Part imu_part(arguments);
  while (const std::optional<ImuSample> sample = bag->nextImu()) {
    analyses->has_gyroscope = analyses->has_accelerometer = true;
    if (!imu_part.holds(sample->time)) continue;
    analyses->gyroscope.add(sample->time, sample->angular_velocity_B);
    analyses->accelerometer.add(sample->time, sample->specific_force_B);
  }
  Part magnetometer_part(arguments);
  while (const std::optional<MagnetometerSample> sample = bag->nextMagnetometer()) {
    analyses->has_magnetometer = true;
    if (magnetometer_part.holds(sample->time)) analyses->magnetometer.add(sample->time, sample->field_M);
  }
  if (analyses->has_gyroscope || analyses->has_magnetometer) return;
  throw InputError(arguments.data + ": holds no readings of an IMU or a magnetometer");
}

void readLog(const AllanArguments& arguments, Diagnostics* diagnostics, Analyses* analyses) {
  const std::unique_ptr<SensorLog> log = openSensorLog(arguments.data, {}, diagnostics);
  analyses->has_gyroscope = log->sensors().has_gyroscope;
  analyses->has_accelerometer = log->sensors().has_accelerometer;
  analyses->has_magnetometer = log->sensors().has_magnetometer;
  LogReading reading;
  for (Part part(arguments); log->next(&reading);) {
    if (!part.holds(reading.time)) continue;
    if (reading.angular_velocity) analyses->gyroscope.add(reading.time, *reading.angular_velocity);
    if (reading.specific_force) analyses->accelerometer.add(reading.time, *reading.specific_force);
    if (reading.field) analyses->magnetometer.add(reading.time, *reading.field);
  }
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

void allan(const AllanArguments& arguments) {
  Diagnostics diagnostics;
  Analyses analyses(&diagnostics);
  refuseBagOptions(arguments.data, arguments.bag);
  refuseRigOfFolder(arguments.data, arguments.bag);
  if (isBag(arguments.data) || isVideo(arguments.data)) {
    readRecording(arguments, &diagnostics, &analyses);
  } else if (isSensorLog(arguments.data)) {
    readLog(arguments, &diagnostics, &analyses);
  } else {
    readFolder(arguments, &diagnostics, &analyses);
  }
  const std::vector<SensorNoise> sensors = analyses.finish();
  if (!arguments.output.empty()) {
    const std::filesystem::path folder = arguments.output;
    createOutputFolder(folder);
    if (analyses.has_gyroscope && analyses.has_accelerometer) {
      writeOutput(folder / "imu.yaml", kalibrImuYaml(sensors[0], sensors[1]));
    }
    if (analyses.has_magnetometer)
      writeOutput(folder / "magnetometer.yaml", magnetometerYaml(sensors.back()));
    drawFigures(sensors, folder, &diagnostics);
  }
  if (!arguments.json.empty()) {
    nlohmann::ordered_json json = noiseJson(sensors);
    json["findings"] = findingsJson(diagnostics);
    writeOutput(arguments.json, jsonText(json) + "\n");
  }
  fmt::print("{}{}", noiseTable(sensors), findingsText(diagnostics));
}

}  // namespace

void addAllanCommand(CLI::App& program) {
  const auto arguments = std::make_shared<AllanArguments>();
  CLI::App* command = program.add_subcommand(
      "allan", "Noise of gyroscope, accelerometer and magnetometer from a record at rest");
  command
      ->add_option("DATA", arguments->data,
                   "folder with mav0 (EuRoC ASL layout), ROS bag or film with telemetry, cameras and "
                   "calibration may be missing; or a sensor log: a CSV file, a folder or zip of them, a log of "
                   "PX4 or ArduPilot")
      ->required();
  addBagOptions(&arguments->bag, command);
  command->add_option("-o,--output", arguments->output,
                      "folder for imu.yaml (Kalibr), magnetometer.yaml and plots; made where it is missing");
  command->add_option("--json", arguments->json, "write all figures and curves to this file");
  command
      ->add_option("--skip", arguments->skip_s, "leave out the first so many seconds, while sensors warm up")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--duration", arguments->duration_s, "use so many seconds; 0 for all")
      ->check(CLI::NonNegativeNumber);
  command->footer(
      "Record the rig lying still on solid ground, for hours: white noise takes minutes to know to 5 %, "
      "bias\n"
      "instability and random walk hours.\n"
      "A CSV file has a header with units, `t [s], wx [rad/s], wy [rad/s], wz [rad/s], ax [m/s^2], … , mx "
      "[uT], …`,\n"
      "or no header and a time with 3 (magnetometer), 6 (gyroscope, accelerometer) or 9 numbers.\n"
      "Examples:\n"
      "  lodeline allan bench -o bench_noise --json bench_noise/figures.json\n"
      "  lodeline allan rest.csv --skip 600");
  command->callback([arguments] { allan(*arguments); });
}

}  // namespace lodeline
