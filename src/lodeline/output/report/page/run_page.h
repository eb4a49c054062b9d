#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "lodeline/output/report/page/run_evaluation.h"

namespace lodeline {

/// Landmarks that a page shows of a run at most.
inline constexpr size_t kMostLandmarks = 100000;

/// Everything that the page shows of a run, from its output folder (`Run` in web/src/data.ts). Only
/// states.csv must be there; what else is missing (an older run, one that was killed) is left out. Throws
/// InputError where a file cannot be read or the reference does not fit.
nlohmann::ordered_json runPageJson(const std::filesystem::path& run,
                                   const std::optional<ReportReference>& reference, Diagnostics* diagnostics);

}  // namespace lodeline
