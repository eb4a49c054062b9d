#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lodeline/output/report/page/report_options.h"

namespace lodeline {

/// The template with data (`PageData` in web/src/data.ts). Throws UsageError where the program was built
/// without the page.
std::string fillPage(const nlohmann::ordered_json& data);

/// A self-contained HTML page of one or more runs from their output folders; docs/how-to/report.md describes
/// its content. Throws as runPageJson() and fillPage().
std::string reportPage(const std::vector<std::filesystem::path>& runs, const ReportOptions& options,
                       Diagnostics* diagnostics);

}  // namespace lodeline
