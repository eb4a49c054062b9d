#include "apps/lodeline/attitude_command.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "apps/lodeline/shared/bag_options.h"
#include "apps/lodeline/shared/common_options.h"
#include "lodeline/diagnostics.h"
#include "lodeline/inspection/start_check.h"
#include "lodeline/io/streams/ordered_stream.h"
#include "lodeline/io/streams/time_span.h"
#include "lodeline/io/synchronizer/inertial_stream.h"
#include "lodeline/magnetometer/calibration/calibration_file.h"
#include "lodeline/magnetometer/calibration/heading/axis_checks.h"
#include "lodeline/output/files/attitude_writer.h"
#include "lodeline/output/report/findings.h"
#include "lodeline/pipeline/open_recording.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/json_text.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

struct AttitudeArguments {
  std::string data;
  BagArguments bag;
  std::string output;
  std::string magnetometer_calibration;
  SiteArguments site;
  RecordingPart part;
  Verbosity verbosity;
  double rate_hz = 20.0;
  double magnetometer_lag_s = 0.0;
  bool no_magnetometer = false;
};

/// Opens DATA and applies the options of the command line to its magnetometer.
template <typename Source>
std::unique_ptr<RecordedSource> prepared(std::unique_ptr<Source> source, const AttitudeArguments& arguments,
                                         Diagnostics* diagnostics) {
  Rig rig = source->rig();
  if (!arguments.magnetometer_calibration.empty()) {
    const MagnetometerFit fit = readCalibrationFile(arguments.magnetometer_calibration);
    applyCalibration(fit, arguments.magnetometer_calibration, &rig);
    if (fit.dip_rad && arguments.site.position.empty()) reportNegativeDip(*fit.dip_rad, diagnostics);
  }
  if (rig.magnetometer) {
    rig.magnetometer->time_offset_to_imu_s -= arguments.magnetometer_lag_s;
    source->setMagnetometer(*rig.magnetometer);
  }
  return source;
}

std::unique_ptr<RecordedSource> openSource(const AttitudeArguments& arguments, Diagnostics* diagnostics) {
  refuseBagOptions(arguments.data, arguments.bag);
  EurocOptions options;
  options.with_cameras = false;
  return prepared(openRecording(arguments.data, options, arguments.bag, diagnostics), arguments, diagnostics);
}

AttitudeFilterOptions filterOptions(const AttitudeArguments& arguments) {
  AttitudeFilterOptions options;
  options.site_field_W = arguments.site.field_ENU();
  return options;
}

std::string northOf(const AttitudeArguments& arguments, bool has_magnetometer) {
  if (!has_magnetometer) return "the first attitude (no magnetometer)";
  return arguments.site.position.empty() ? "magnetic north" : "true north";
}

StreamExpectation expectation(const std::string& name, double rate_hz, double offset_s) {
  StreamExpectation expected{name, name, rate_hz, 4.0 / rate_hz, Duration::fromSeconds(offset_s)};
  expected.spreads_bursts = true;
  return expected;
}

/// Without images, the rotation of gravity shows the gyroscope's unit.
InertialScreenOptions screenOptions(const AttitudeArguments& arguments, Diagnostics* diagnostics) {
  InertialScreenOptions options;
  const SourceFactory open = [&](Diagnostics* unheard) { return openSource(arguments, unheard); };
  options.rate_to_SI = checkStart(open, arguments.data, {}, diagnostics).rate_to_SI;
  return options;
}

void filterAll(RecordedSource& source, const AttitudeArguments& arguments,
               const InertialScreenOptions& screen, AttitudeFilter* filter, AttitudeWriter* writer,
               Diagnostics* diagnostics) {
  const std::optional<MagnetometerCalibration>& magnetometer = source.rig().magnetometer;
  InertialScreen imu = inertialStream(
      {expectation("imu", source.rig().imu.rate_hz, 0.0), [&] { return source.nextImu(); }, diagnostics},
      screen, diagnostics);
  OrderedStream<MagnetometerSample> field(
      expectation("magnetometer", magnetometer ? magnetometer->rate_hz : 1.0,
                  magnetometer ? magnetometer->time_offset_to_imu_s : 0.0),
      [&] { return source.nextMagnetometer(); }, diagnostics);
  Progress progress("reading", arguments.verbosity.quiet);
  std::optional<Time> first, next_output;
  SpanOfStream imu_span, field_span;
  while (imu.peek() != nullptr) {
    const ImuSample sample = imu.pop();
    progress.show(source.shareRead());
    if (!first) first = sample.time;
    if ((sample.time - *first).seconds() < arguments.part.from_s) continue;
    if (arguments.part.to_s && (sample.time - *first).seconds() > *arguments.part.to_s) break;
    imu_span.add(sample.time);
    filter->add(sample);
    while (magnetometer && field.peek() != nullptr && field.peek()->time <= sample.time) {
      field_span.add(field.peek()->time);
      filter->add(field.pop());
    }
    if (!filter->estimate() || (next_output && sample.time < *next_output)) continue;
    writer->write(*filter->estimate());
    if (arguments.rate_hz > 0.0) next_output = sample.time + Duration::fromSeconds(1.0 / arguments.rate_hz);
  }
  progress.end();
  while (magnetometer && field.peek() != nullptr) field_span.add(field.pop().time);
  if (!imu_span.get() || !field_span.get()) return;
  const std::optional<std::string> words =
      apart("the magnetometer", *field_span.get(), "the inertial readings", *imu_span.get(),
            "time_offset_to_imu_s of its calibration");
  if (words) diagnostics->report(Severity::Serious, kClocksApart, *words);
}

void attitude(const AttitudeArguments& arguments) {
  Diagnostics diagnostics;
  const AttitudeFilterOptions options = filterOptions(arguments);
  const std::unique_ptr<RecordedSource> source = openSource(arguments, &diagnostics);
  std::optional<MagnetometerCalibration> magnetometer = source->rig().magnetometer;
  if (arguments.no_magnetometer) magnetometer.reset();
  if (magnetometer && !magnetometer->is_calibrated) {
    diagnostics.report(
        Severity::Warning, "magnetometer_uncalibrated",
        "the magnetometer is not calibrated: its iron turns heading by an unknown angle; see `lodeline "
        "calibrate magnetometer`");
  }
  const std::filesystem::path folder = arguments.output;
  createOutputFolder(folder);
  AttitudeWriter writer(folder);
  AttitudeFilter filter(options, magnetometer, &diagnostics);
  filterAll(*source, arguments, screenOptions(arguments, &diagnostics), &filter, &writer, &diagnostics);
  const bool is_dip_judged =
      !arguments.site.position.empty() || diagnostics.count("magnetometer_reversed") > 0;
  if (filter.referenceField() && !is_dip_judged)
    reportNegativeDip(filter.referenceField()->dip_rad, &diagnostics);
  writer.finish();
  const std::string north = northOf(arguments, magnetometer.has_value());
  nlohmann::ordered_json json = writer.json(north);
  json["findings"] = findingsJson(diagnostics);
  writeOutput(folder / "attitude.json", jsonText(json) + "\n");
  if (!arguments.verbosity.quiet) fmt::print("{}", writer.text(north));
  printFindings(diagnostics, arguments.verbosity);
  if (writer.count() == 0) throw EstimationError(arguments.data + ": no IMU reading could be used");
}

}  // namespace

void addAttitudeCommand(CLI::App& program) {
  const auto arguments = std::make_shared<AttitudeArguments>();
  CLI::App* command = program.add_subcommand(
      "attitude", "Orientation and heading from gyroscope, accelerometer and magnetometer, without images");
  command
      ->add_option("DATA", arguments->data,
                   "EuRoC folder (mav0), ROS bag (.bag, .mcap, .db3, folder), film or sensor log (CSV, zip, "
                   "PX4, ArduPilot)")
      ->required();
  addBagOptions(&arguments->bag, command);
  command
      ->add_option("-o,--output", arguments->output, "folder for attitude.csv, attitude.tum, attitude.json")
      ->required();
  command->add_option("--mag-calibration", arguments->magnetometer_calibration,
                      "what `lodeline calibrate magnetometer` wrote");
  addSite(&arguments->site, command);
  addRecordingPart(&arguments->part, command);
  command
      ->add_option("--rate-hz", arguments->rate_hz,
                   "rows per second of attitude.csv; 0 writes one for each IMU reading")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--magnetometer-lag-s", arguments->magnetometer_lag_s,
                   "delay of the magnetometer's readings")
      ->check(CLI::Range(-0.4, 0.4));
  command->add_flag("--no-magnetometer", arguments->no_magnetometer,
                    "do not use the magnetometer; the heading counts from the first attitude");
  addVerbosity(&arguments->verbosity, command);
  command->footer(
      "Orientation is body to world, x east, y north, z up. heading is the azimuth of the body's x axis.\n"
      "Examples:\n"
      "  lodeline attitude dive1 -o attitude --mag-calibration mag.yaml --site 29.83,-82.60,0 --date "
      "2026-11-21\n"
      "  lodeline attitude readings.csv -o attitude --no-magnetometer");
  command->callback([arguments] { attitude(*arguments); });
}

}  // namespace lodeline
