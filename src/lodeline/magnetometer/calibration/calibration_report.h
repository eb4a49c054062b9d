#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/magnetometer/calibration/calibrate_magnetometer.h"
#include "lodeline/magnetometer/iron/heading_error.h"

namespace lodeline {

/// What a person wants to know: verdict, parameters with standard deviations, figures of merit, and what was
/// not possible and why.
std::string calibrationText(const MagnetometerCalibrationResult& result);

/// The same for programs; keys carry units.
nlohmann::ordered_json calibrationJson(const MagnetometerCalibrationResult& result);

/// How two calibrations differ and whether that matters, `dip_rad` as in compareCalibrations().
std::string comparisonText(const MagnetometerFit& first, const MagnetometerFit& second, double dip_rad);
nlohmann::ordered_json comparisonJson(const MagnetometerFit& first, const MagnetometerFit& second,
                                      double dip_rad);

}  // namespace lodeline
