#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/output/report/page/run_evaluation.h"

namespace lodeline {

/// The template with data (`PageData` in web/src/data.ts) put in. Throws UsageError where the program was
/// built without the page.
std::string fillPage(const nlohmann::ordered_json& data);

/// One self-contained HTML page that shows runs, given their output folders; docs/report.md says what is on
/// it. Throws as runPageJson() and fillPage().
std::string reportPage(const std::vector<std::filesystem::path>& runs,
                       const std::optional<ReportReference>& reference, Diagnostics* diagnostics);

}  // namespace lodeline
