#pragma once

#include <string>
#include <vector>

#include "lodeline/batch/estimator_log.h"

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

struct RefinementSummary {
  /// Reason why there is no batch solution; empty where there is one.
  std::string refusal;
  bool converged = false;  ///< the last round converged
  int states = 0;
  int64_t landmarks = 0;
  int64_t observations = 0;           ///< of these
  double observation_variance = 1.0;  ///< of an observation over the stated one (TimeCorrelatedErrors)
  double design_effect = 1.0;         ///< observations that count as one in the reported covariance
  double outlier_share = 0.0;         ///< of the observations, removed at the end
  int iterations = 0;                 ///< of all rounds
  double forward_cost = 0.0;          ///< of the forward run's states
  double first_round_cost = 0.0;      ///< cost of the same terms after the first round
  double cost = 0.0;                  ///< cost of the remaining terms at the end
  double moved_rms_m = 0.0;           ///< difference of refined and forward positions, over all frames
  double moved_max_m = 0.0;
  double turned_rms_rad = 0.0;
  double forward_sigma_m = 0.0,
         sigma_m = 0.0;  ///< reported for the last frame: root of the trace of the position covariance
  double processor_s = 0.0;
  bool has_covariance = false;

  bool usable() const { return refusal.empty(); }
};

/// The batch solution of a whole recording.
struct Refinement {
  RefinementSummary summary;
  /// Estimates of all frames of the record from all measurements, before and after each frame; those of the
  /// forward run where there is no solution. Covariance as in FrameEstimate, of the batch solution; nan where
  /// it was not computed.
  std::vector<FrameEstimate> frames;
  std::vector<MapPoint> landmarks;
};

/// Solves for all states of a finished record at once (Levenberg-Marquardt on BatchProblem), starting from
/// the forward run. The frames between states follow the inertial readings. For the same terms the cost never
/// exceeds that of the forward run. If the result is doubtful, RefinementSummary::refusal gives the reason,
/// and the frames are those of the forward run. `rig` and `options` as in that run.
Refinement refine(const Rig& rig, const EstimatorOptions& options, const EstimatorLog& record,
                  const RefinementOptions& wanted = {});

}  // namespace lodeline
