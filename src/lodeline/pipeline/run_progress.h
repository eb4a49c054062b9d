#pragma once

#include <optional>

#include "lodeline/output/report/run_summary.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {

/// Progress of a run, see Progress: its share, speed, path length and state.
class RunProgress {
 public:
  /// `length_s`: of the part that is read; 0 where the run reads to the end of the recording.
  RunProgress(bool quiet, double length_s) : progress_("run", quiet), length_s_(length_s) {}

  /// `share_read`: of the recording, 0 to 1; nothing where it is unknown.
  void show(const RunSummary& summary, std::optional<double> share_read);
  /// Clears the line before other output.
  void end() { progress_.end(); }

 private:
  Progress progress_;
  double length_s_;
  std::optional<Time> first_;
};

}  // namespace lodeline
