#pragma once

#include <vector>

#include "lodeline/evaluation/figures/gnuplot.h"
#include "lodeline/magnetometer/calibration/calibrate_magnetometer.h"

namespace lodeline {

/// The raw and corrected readings in the three coordinate planes, with the circle of the field strength.
gnuplot::Figure cloudFigure(const MagnetometerCalibrationResult& result);

/// Number of readings in each of the 72 bins of SphereCoverage, in an equal-area map: azimuth in the sensor's
/// x-y plane by the z component.
gnuplot::Figure coverageFigure(const MagnetometerCalibrationResult& result);

}  // namespace lodeline
