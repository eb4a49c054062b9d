#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/lodeline/batch/batch_summary.h"
#include "apps/lodeline/benchmark/benchmark_set.h"

namespace lodeline {

/// One sequence in the table of a benchmark.
struct BenchmarkRow {
  const SetSequence* sequence = nullptr;
  std::string status;  ///< as in BatchRow; "broken" where it cannot be run
  std::optional<BatchErrors> errors;
  std::string reason;  ///< of a failure, or why there are no errors

  /// Whether the run is complete and compared with the truth.
  bool isGood() const { return status == "done" && errors.has_value(); }
};

/// The figures of all sequences beside the published ones, and the sources of these.
std::string benchmarkMarkdown(const BenchmarkSet& set, const std::vector<BenchmarkRow>& rows,
                              const std::vector<std::string>& absent);
/// The same figures as a table, without sources.
std::string benchmarkCsv(const BenchmarkSet& set, const std::vector<BenchmarkRow>& rows);

}  // namespace lodeline
