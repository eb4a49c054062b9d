#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lodeline/output/files/run_table.h"

namespace lodeline {

/// Maximum number of rows of a table on a page.
inline constexpr size_t kMostRows = 8000;
/// The same for all runs together, where a page has several.
inline constexpr size_t kMostRowsOfAllRuns = 10000;

/// A number with six significant digits, enough for a figure; null for values that are not finite.
nlohmann::json shortNumber(double value);
nlohmann::json shortNumbers(const std::vector<double>& values, const std::vector<size_t>& rows);

/// Times (s since `origin_ns`, ms resolution) of some rows.
nlohmann::json secondsSince(int64_t origin_ns, const std::vector<int64_t>& stamp_ns,
                            const std::vector<size_t>& rows);

/// A table in the format of the page (`Table` in web/src/data.ts), with about `most` rows from chooseRows()
/// at most, and the columns that `is_wanted` accepts; all where it is not set.
nlohmann::ordered_json tableJson(const RunTable& table, int64_t origin_ns, size_t most = kMostRows,
                                 const std::function<bool(const std::string&)>& is_wanted = nullptr);

}  // namespace lodeline
