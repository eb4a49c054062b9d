#pragma once

#include <vector>

#include "lodeline/evaluation/figures/gnuplot.h"
#include "lodeline/magnetometer/calibration/calibrate_magnetometer.h"

namespace lodeline {

/// The readings in the three coordinate planes, as read and corrected, with the circle that they should fill.
gnuplot::Figure cloudFigure(const MagnetometerCalibrationResult& result);

/// How often the field was seen in each of the 72 bins of SphereCoverage, in an equal-area map: azimuth in
/// the sensor's x-y plane by the z component.
gnuplot::Figure coverageFigure(const MagnetometerCalibrationResult& result);

}  // namespace lodeline
