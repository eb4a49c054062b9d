#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "lodeline/diagnostics.h"

namespace lodeline {

/// Whether the page shows a column of states.csv: of covariances only those of the position, and nothing of
/// the attitude filter, which has its own command.
bool isForThePage(const std::string& column);

/// The solutions of a run beside the one that the page shows first (`Solution[]` in web/src/data.ts): that of
/// the run itself (`kind` "run") where it was refined, and the poses in the map of the run ("map").
nlohmann::ordered_json otherSolutionsJson(const std::filesystem::path& run, bool is_refined,
                                          int64_t origin_ns, size_t most_rows, Diagnostics* diagnostics);

}  // namespace lodeline
