#pragma once

#include <chrono>

#include "lodeline/output/report/run_summary.h"

namespace lodeline {

/// Progress of a run on standard error: one line that is rewritten on a terminal, or occasional lines in a
/// log.
class RunProgress {
 public:
  explicit RunProgress(bool quiet);

  void show(const RunSummary& summary);
  /// Clears the line before other output.
  void end() const;

 private:
  bool quiet_;
  bool terminal_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace lodeline
