#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/evaluation/figures/gnuplot.h"
#include "lodeline/magnetometer/calibration/currents/calibrate_currents.h"

namespace lodeline {

/// Report for the user: verdict, the field of each channel with its share, residual before and after, and
/// what the test does not tell.
std::string currentText(const CurrentCalibrationResult& result);

/// The same report as JSON; keys carry units.
nlohmann::ordered_json currentJson(const CurrentCalibrationResult& result);

/// The field of the currents and what the compensation leaves of it, over time, above the currents.
gnuplot::Figure currentFigure(const CurrentCalibrationResult& result);

}  // namespace lodeline
