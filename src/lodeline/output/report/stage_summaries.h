#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/estimate.h"

namespace lodeline {

/// Calibration states of the cameras, in words and for run.json.
std::string describe(const CameraCorrections& corrections);
nlohmann::ordered_json toJson(const CameraCorrections& corrections);
/// Summaries of the stages after the estimator, in words and for run.json.
std::string describe(const RefinementSummary& refined);
nlohmann::ordered_json toJson(const RefinementSummary& refined);
std::string describe(const MappingSummary& mapping);
nlohmann::ordered_json toJson(const MappingSummary& mapping);

}  // namespace lodeline
