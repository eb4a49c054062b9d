#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "lodeline/output/report/page/run_evaluation.h"

namespace lodeline {

/// Maximum number of landmarks of a run on a page.
inline constexpr size_t kMostLandmarks = 100000;

/// All data of a run for the page, from its output folder (`Run` in web/src/data.ts). Only states.csv is
/// required; other missing files (of an older or killed run) are left out. Throws InputError where a file
/// cannot be read or the reference does not fit.
nlohmann::ordered_json runPageJson(const std::filesystem::path& run,
                                   const std::optional<ReportReference>& reference, Diagnostics* diagnostics);

}  // namespace lodeline
