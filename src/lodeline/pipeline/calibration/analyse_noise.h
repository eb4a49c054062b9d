#pragma once

#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/imu/noise/sensor_noise.h"
#include "lodeline/pipeline/open_recording.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {

/// A record at rest, and its part to be analysed.
struct NoiseRequest {
  std::string data;  ///< folder, bag or table of readings
  BagArguments bag;
  double skip_s = 0.0;      ///< from the first reading on
  double duration_s = 0.0;  ///< after that; 0 for all
  ShareDone progress = [](double) {};
};

/// The noise of the sensors of a record, in the order gyroscope, accelerometer, magnetometer. Sensors that it
/// does not have are left out. Throws InputError and UsageError.
std::vector<SensorNoise> analyseNoise(const NoiseRequest& request, Diagnostics* diagnostics);

}  // namespace lodeline
