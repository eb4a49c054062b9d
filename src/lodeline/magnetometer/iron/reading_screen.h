#pragma once

#include <span>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Usable magnetometer readings and counts of the rejected ones.
struct ReadingScreen {
  std::vector<MagnetometerSample> usable;
  int repeated = 0;  ///< equal to the previous reading in all axes
  int not_finite = 0;
  int saturated = 0;   ///< at the end of the sensor's range in at least one axis
  int disordered = 0;  ///< not later than the previous reading
  double longest_frozen_s = 0.0;
};

/// Selects the readings that a calibration can use and reports the others as findings. A sensor that repeats
/// each reading until it has a new one loses only the repetitions. An axis that reaches its extreme value
/// again and again is saturated there, and these readings are rejected.
ReadingScreen screenReadings(std::span<const MagnetometerSample> samples, Diagnostics* diagnostics);

}  // namespace lodeline
