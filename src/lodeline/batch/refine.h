#pragma once

#include <functional>
#include <string>
#include <vector>

#include "lodeline/batch/estimator_log.h"
#include "lodeline/batch/loops/loop_observation.h"
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
  std::function<void(double share)> progress = {};  ///< takes the share of the rounds that are done
};

/// Solves for all states of a finished record at once (Levenberg-Marquardt on BatchProblem), starting from
/// the forward run. The frames between states follow the inertial readings. For the same terms the cost never
/// exceeds that of the forward run. If the result is doubtful, RefinementSummary::refusal gives the reason,
/// and the frames are those of the forward run. `rig` and `options` as in that run.
Refinement refine(const Rig& rig, const EstimatorOptions& options, const EstimatorLog& record,
                  const RefinementOptions& wanted = {});

/// The same with loops: old landmarks are observed again by the frames that came back to them. The first
/// round starts from LoopClosures::initial_poses, so `forward_cost` is that of these poses. Observations that
/// contradict the others of their landmark are left out, with the landmark's part that they would have
/// joined. Without loop observations the result is that of the function above. Throws InputError where an
/// observation has no such camera, or an initial pose no frame.
Refinement refine(const Rig& rig, const EstimatorOptions& options, const EstimatorLog& record,
                  const LoopClosures& loops, const RefinementOptions& wanted = {});

}  // namespace lodeline
