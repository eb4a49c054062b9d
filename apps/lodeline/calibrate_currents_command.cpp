#include "apps/lodeline/calibrate_currents_command.h"

#include <fmt/core.h>

#include "lodeline/evaluation/figures/plots.h"
#include "lodeline/magnetometer/calibration/calibration_file.h"
#include "lodeline/magnetometer/calibration/currents/calibrate_currents.h"
#include "lodeline/magnetometer/calibration/currents/current_report.h"
#include "lodeline/output/report/findings.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/json_text.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {

void calibrateCurrentsFromTest(const CalibrateCurrentsArguments& arguments) {
  std::optional<MagnetometerFit> iron;
  if (!arguments.iron.empty()) iron = readCalibrationFile(arguments.iron);
  std::optional<CurrentCalibration> earlier;
  if (!arguments.check.empty()) earlier = readCurrentFile(arguments.check);
  EurocOptions options;
  options.with_cameras = false;
  options.needs_imu = false;
  options.needs_calibration = false;
  Diagnostics diagnostics;
  const std::unique_ptr<RecordedSource> source =
      openRecording(arguments.data, options, arguments.bag, &diagnostics);
  CurrentCalibrationResult result;
  Progress progress("reading", arguments.verbosity.quiet);
  RecordOptions reading = arguments.record;
  reading.progress = progress.function();
  try {
    const StillTest test = readStillTest(*source, arguments.data, true, reading, iron, &diagnostics);
    progress.begin("calibration");
    result = calibrateCurrents(test, earlier, &diagnostics);
    progress.end();
  } catch (const EstimationError&) {
    progress.end();
    printFindings(diagnostics, arguments.verbosity);
    throw;
  }
  if (!arguments.output.empty()) writeCurrentFile(result, arguments.output);
  if (!arguments.plots.empty()) drawFigures({currentFigure(result)}, arguments.plots, diagnostics);
  nlohmann::ordered_json json = currentJson(result);
  json["findings"] = findingsJson(diagnostics);
  if (!arguments.json.empty()) writeOutput(arguments.json, jsonText(json) + "\n");
  if (!arguments.verbosity.quiet) fmt::print("{}", currentText(result));
  printFindings(diagnostics, arguments.verbosity);
}

}  // namespace lodeline
