#pragma once

#include <string>
#include <vector>

#include "lodeline/batch/estimator_log.h"
#include "lodeline/estimate.h"

namespace lodeline {

struct RefinementOptions {
  double state_interval_s = EstimatorLog::kStateInterval_s;  ///< see EstimatorLog
  int max_iterations = 25;                                   ///< of each round
  int rounds = 3;  ///< landmarks are triangulated and outliers removed before each
  /// A round ends after a step that reduces the cost by less than this. The cost one sigma away from the
  /// solution, in any direction, is larger by 0.5.
  double gain_tolerance = 0.01;
  /// Largest share of contradicting observations with which a solution is accepted.
  double max_outlier_share = 0.2;
  /// Covariances are not computed where the linear system needs more memory than this.
  double max_covariance_MB = 4000.0;
};

/// Solves for all states of a finished record at once (Levenberg-Marquardt on BatchProblem), starting from
/// the forward run. The frames between states follow the inertial readings. For the same terms the cost never
/// exceeds that of the forward run. If the result is doubtful, RefinementSummary::refusal gives the reason,
/// and the frames are those of the forward run. `rig` and `options` as in that run.
Refinement refine(const Rig& rig, const EstimatorOptions& options, const EstimatorLog& record,
                  const RefinementOptions& wanted = {});

}  // namespace lodeline
