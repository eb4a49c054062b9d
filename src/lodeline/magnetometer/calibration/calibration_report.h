#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/magnetometer/calibration/calibrate_magnetometer.h"
#include "lodeline/magnetometer/iron/heading_error.h"

namespace lodeline {

/// Report for the user: verdict, parameters with standard deviations, quality figures, and the steps that
/// were impossible, with reasons.
std::string calibrationText(const MagnetometerCalibrationResult& result);

/// The same report as JSON; keys carry units.
nlohmann::ordered_json calibrationJson(const MagnetometerCalibrationResult& result);

/// Differences between two calibrations and their significance; `dip_rad` as in compareCalibrations().
std::string comparisonText(const MagnetometerFit& first, const MagnetometerFit& second, double dip_rad);
nlohmann::ordered_json comparisonJson(const MagnetometerFit& first, const MagnetometerFit& second,
                                      double dip_rad);

}  // namespace lodeline
