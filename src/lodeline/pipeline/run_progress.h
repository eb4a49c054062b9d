#pragma once

#include <chrono>

#include "lodeline/output/report/run_summary.h"

namespace lodeline {

/// What a run shows on standard error while it works: one line that is rewritten on a terminal, or now and
/// then a line in a log.
class RunProgress {
 public:
  explicit RunProgress(bool quiet);

  void show(const RunSummary& summary);
  /// Clears the line for what is printed next.
  void end() const;

 private:
  bool quiet_;
  bool terminal_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace lodeline
