#pragma once

#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/output/report/page/run_evaluation.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {

/// An estimate for the page: its path on the command line, and its trajectory.
struct PageEstimate {
  std::string path;
  std::string name;  ///< differs from those of the others
  const Trajectory* trajectory = nullptr;
};

/// The page of `lodeline report` for estimates and a reference. Folders of runs appear with all their data;
/// trajectories of other programs with their poses. Throws InputError and UsageError as reportPage() does.
std::string evaluationPage(const std::vector<PageEstimate>& estimates, const ReportReference& reference,
                           const ShareDone& progress, Diagnostics* diagnostics);

}  // namespace lodeline
