#pragma once

#include <span>
#include <vector>

#include "lodeline/sensors/measurements.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// What was wrong with magnetometer readings.
struct ReadingScreen {
  std::vector<MagnetometerSample> usable;
  int repeated = 0;  ///< equal to the reading before in all axes
  int not_finite = 0;
  int saturated = 0;   ///< at the end of the sensor's range in some axis
  int disordered = 0;  ///< not later than the reading before
  double longest_frozen_s = 0.0;
};

/// Passes on what a calibration can use and reports the rest as findings. A sensor that repeats each reading
/// until it has a new one loses the repetitions only; an axis whose outermost value is met again and again is
/// saturated there, and these readings go.
ReadingScreen screenReadings(std::span<const MagnetometerSample> samples, Diagnostics* diagnostics);

}  // namespace lodeline
