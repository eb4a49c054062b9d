#include "apps/lodeline/calibrate_command.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <numbers>

#include "apps/lodeline/calibrate_cameras_command.h"
#include "apps/lodeline/calibrate_currents_command.h"
#include "apps/lodeline/shared/bag_options.h"
#include "apps/lodeline/shared/common_options.h"
#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/figures/plots.h"
#include "lodeline/magnetometer/calibration/calibration_file.h"
#include "lodeline/magnetometer/calibration/calibration_plots.h"
#include "lodeline/magnetometer/calibration/calibration_report.h"
#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"
#include "lodeline/output/report/findings.h"
#include "lodeline/pipeline/open_recording.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/json_text.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

const char* const kCalibrateFooter =
    R"(Readings of the IMU in DATA also give the rotation to the IMU and the lag.
A text file has the header `t [s], mx [uT], my [uT], mz [uT]`, or rows of t, mx, my, mz or mx, my, mz.
docs/how-to/calibrate-magnetometer.md explains how to move the rig, docs/how-to/compensate-currents.md the still test.
Examples:
  lodeline calibrate magnetometer dive1 -o mag.yaml --to 90 --site 29.83,-82.60,20 --date 2026-11-21
  lodeline calibrate magnetometer cloud.txt --unit mG -o mag.yaml --plots plots
  lodeline calibrate magnetometer after.yaml --compare before.yaml
  lodeline calibrate magnetometer still_test --currents -o currents.yaml --old mag.yaml
  lodeline calibrate magnetometer still_test_2 --currents --check currents.yaml)";

struct CalibrateArguments {
  std::string data;
  BagArguments bag;
  std::string output;
  std::string unit;
  RecordingPart part;
  SiteArguments site;
  Verbosity verbosity;
  std::string old;
  std::string compare;
  std::string json;
  std::string plots;
  bool currents = false;
  std::string check;
};

RecordOptions recordOptions(const CalibrateArguments& arguments) {
  RecordOptions options;
  options.from_s = arguments.part.from_s;
  options.to_s = arguments.part.to_s;
  if (arguments.unit.empty()) return options;
  options.unit = fieldUnitFromString(arguments.unit);
  if (!options.unit) {
    throw UsageError(fmt::format("--unit {}: must be T, uT, nT, mG, G or raw", arguments.unit));
  }
  return options;
}

double comparisonDip_rad(const std::optional<Vec3>& site_field_ENU, const MagnetometerFit& first,
                         const MagnetometerFit& second) {
  if (site_field_ENU) return fieldElements(*site_field_ENU).inclination_rad;
  if (second.dip_rad) return *second.dip_rad;
  return first.dip_rad.value_or(std::numbers::pi / 3.0);
}

void requireComparable(const MagnetometerFit& first, const MagnetometerFit& second, const std::string& file) {
  if (first.raw_readings != second.raw_readings) {
    throw InputError(file +
                     ": one calibration is for raw counts and the other for tesla; they cannot be compared");
  }
  if (!(first.field_strength_T > 0.0 && second.field_strength_T > 0.0)) {
    throw InputError(file + ": a comparison needs key 'field_strength_T' in both calibrations");
  }
}

bool isCalibrationFile(const std::filesystem::path& path) {
  return path.extension() == ".yaml" || path.extension() == ".yml";
}

void calibrateCurrents(const CalibrateArguments& arguments) {
  if (!arguments.compare.empty())
    throw UsageError("--compare is for calibrations of iron; --check compares calibrations of currents");
  if (!arguments.site.position.empty() || !arguments.site.date.empty())
    throw UsageError("--site and --date do not belong to --currents, which needs no field of the Earth");
  calibrateCurrentsFromTest({arguments.data, arguments.bag, recordOptions(arguments), arguments.old,
                             arguments.check, arguments.output, arguments.json, arguments.plots,
                             arguments.verbosity});
}

void calibrate(const CalibrateArguments& arguments) {
  if (arguments.currents) return calibrateCurrents(arguments);
  if (!arguments.check.empty()) throw UsageError("--check belongs to --currents");
  const std::optional<Vec3> site_field_ENU = arguments.site.field_ENU();
  std::optional<MagnetometerFit> first;
  if (!arguments.compare.empty()) first = readCalibrationFile(arguments.compare);
  nlohmann::ordered_json json;
  std::string text;
  MagnetometerFit fit;
  Diagnostics diagnostics;
  if (isCalibrationFile(arguments.data)) {
    if (!first)
      throw UsageError(arguments.data + " is a calibration already; --compare says with which to compare it");
    fit = readCalibrationFile(arguments.data);
  } else {
    CalibrationOptions options;
    options.site_field_ENU = site_field_ENU;
    if (!arguments.old.empty()) options.old = readCalibrationFile(arguments.old);
    Progress progress("reading", arguments.verbosity.quiet);
    RecordOptions reading = recordOptions(arguments);
    reading.progress = progress.function();
    const MagnetometerRecord record =
        readMagnetometerRecord(arguments.data, arguments.bag, reading, &diagnostics);
    MagnetometerCalibrationResult result;
    try {
      progress.begin("calibration");
      result = calibrateMagnetometer(record, options, &diagnostics);
      progress.end();
    } catch (const EstimationError&) {
      progress.end();
      printFindings(diagnostics, arguments.verbosity);
      throw;
    }
    fit = result.fit;
    if (!arguments.output.empty()) writeCalibrationFile(fit, arguments.output);
    if (!arguments.plots.empty())
      drawFigures({cloudFigure(result), coverageFigure(result)}, arguments.plots, diagnostics);
    json = calibrationJson(result);
    text = calibrationText(result);
  }
  if (first) {
    requireComparable(*first, fit, arguments.compare);
    const double dip_rad = comparisonDip_rad(site_field_ENU, *first, fit);
    json["comparison"] = comparisonJson(*first, fit, dip_rad);
    text += comparisonText(*first, fit, dip_rad);
  }
  json["findings"] = findingsJson(diagnostics);
  if (!arguments.json.empty()) writeOutput(arguments.json, jsonText(json) + "\n");
  if (!arguments.verbosity.quiet) fmt::print("{}", text);
  printFindings(diagnostics, arguments.verbosity);
}

void addMagnetometerCommand(CLI::App& calibrate_command) {
  const auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App* command = calibrate_command.add_subcommand(
      "magnetometer",
      "Soft iron, hard iron, rotation to the IMU and lag, with their uncertainties and a verdict");
  command
      ->add_option(
          "DATA", arguments->data,
          "EuRoC folder (mav0), ROS bag, sensor log, text file of readings, or with --compare a calibration")
      ->required();
  addBagOptions(&arguments->bag, command);
  command->add_option("-o,--output", arguments->output,
                      "calibration file, for `lodeline run --mag-calibration`");
  command->add_option(
      "--unit", arguments->unit,
      "unit of a file without header: T, uT, nT, mG, G or raw; without it, found by the size of the field");
  addRecordingPart(&arguments->part, command);
  addSite(&arguments->site, command);
  command->add_option(
      "--old", arguments->old,
      "calibration to use where the readings say too little; with --currents: that of the magnetometer");
  command->add_option("--compare", arguments->compare, "earlier calibration to compare with");
  command->add_option("--json", arguments->json, "write all figures to this file");
  command->add_option("--plots", arguments->plots, "folder for plots of the readings and of the coverage");
  command->add_flag("--currents", arguments->currents,
                    "calibrate the fields of electric currents from a still test, and write the section "
                    "current0 of a rig file");
  command->add_option(
      "--check", arguments->check,
      "with --currents: rig file with an earlier calibration; says whether cables have moved");
  addVerbosity(&arguments->verbosity, command);
  command->footer(kCalibrateFooter);
  command->callback([arguments] { calibrate(*arguments); });
}

}  // namespace

void addCalibrateCommand(CLI::App& program) {
  CLI::App* command = program.add_subcommand("calibrate", "Calibrate a sensor from a recording");
  command->require_subcommand(1);
  addMagnetometerCommand(*command);
  addCalibrateCamerasCommand(*command);
}

}  // namespace lodeline
