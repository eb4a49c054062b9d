#pragma once

#include <string>

#include "apps/lodeline/shared/common_options.h"
#include "lodeline/magnetometer/calibration/magnetometer_record.h"
#include "lodeline/pipeline/open_recording.h"

namespace lodeline {

/// Arguments of `lodeline calibrate magnetometer --currents`.
struct CalibrateCurrentsArguments {
  std::string data;
  BagArguments bag;
  RecordOptions record;
  std::string iron;   ///< calibration of the magnetometer; empty for none
  std::string check;  ///< rig file with an earlier calibration of currents; empty for none
  std::string output, json, plots;
  Verbosity verbosity;
};

/// Calibrates the fields of electric currents from a still test, and prints the report.
void calibrateCurrentsFromTest(const CalibrateCurrentsArguments& arguments);

}  // namespace lodeline
