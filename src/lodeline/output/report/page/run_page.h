#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "lodeline/output/report/page/report_options.h"

namespace lodeline {

/// Maximum number of landmarks of a run on a page, and of points of all walls.
inline constexpr size_t kMostLandmarks = 100000;
inline constexpr size_t kMostWallPoints = 2'000'000;

/// All data of a run for the page, from its output folder (`Run` in web/src/data.ts). `runs`: on the same
/// page, which share the most points and rows. Only states.csv is
/// required; other missing files (of an older or killed run) are left out. Throws InputError where a file
/// cannot be read or the reference does not fit.
nlohmann::ordered_json runPageJson(const std::filesystem::path& run, const ReportOptions& options,
                                   Diagnostics* diagnostics, size_t runs = 1);

}  // namespace lodeline
