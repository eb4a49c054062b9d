#pragma once

#include <string>
#include <vector>

#include "lodeline/batch/estimator_log.h"

namespace lodeline {

struct RefinementOptions {
  double state_interval_s = EstimatorLog::kStateInterval_s;  ///< see EstimatorLog
  int max_iterations = 25;                                   ///< of each round
  int rounds = 3;  ///< landmarks and outliers are sorted out before each
  /// A step that lowers the cost by less ends a round: one sigma off the solution, in any direction, costs
  /// 0.5.
  double gain_tolerance = 0.01;
  /// More observations than this share that contradict the solution speak against it.
  double max_outlier_share = 0.2;
  /// Covariances are left out where the linear system takes more memory than this.
  double max_covariance_MB = 4000.0;
};

struct RefinementSummary {
  /// Why there is no batch solution; empty where there is one.
  std::string refusal;
  bool converged = false;  ///< the last round ended by itself
  int states = 0;
  int64_t landmarks = 0;
  int64_t observations = 0;  ///< of these
  double observation_variance =
      1.0;                     ///< that they were given, of the stated one: TimeCorrelatedErrors::variance()
  double design_effect = 1.0;  ///< so many of them count as one in what is claimed: TimeCorrelatedErrors
  double outlier_share = 0.0;  ///< of the observations, left out at the end
  int iterations = 0;          ///< of all rounds
  double forward_cost = 0.0;   ///< of the forward run's states
  double first_round_cost = 0.0;  ///< of the same terms after the first round
  double cost = 0.0;              ///< of the terms that are left, at the end
  double moved_rms_m = 0.0;       ///< refined against forward positions, over all frames
  double moved_max_m = 0.0;
  double turned_rms_rad = 0.0;
  double forward_sigma_m = 0.0, sigma_m = 0.0;  ///< claimed, at the end: root of the position's trace
  double processor_s = 0.0;
  bool has_covariance = false;

  bool usable() const { return refusal.empty(); }
};

/// The batch solution of a whole recording.
struct Refinement {
  RefinementSummary summary;
  /// One for each frame of the record, with the state as all measurements, before and after it, give it; the
  /// forward run's where there is no solution. Covariance as in FrameEstimate, of the batch solution; nan
  /// where it was left out.
  std::vector<FrameEstimate> frames;
  std::vector<MapPoint> landmarks;
};

/// Solves for all states of a finished record at once (Levenberg-Marquardt on BatchProblem), starting from
/// the forward run; the frames between states follow the inertial readings. On the same terms the cost never
/// comes out higher than that of the forward run; what makes the result doubtful ends up in
/// RefinementSummary::refusal, with the forward run's frames as they were. `rig` and `options` as of that
/// run.
Refinement refine(const Rig& rig, const EstimatorOptions& options, const EstimatorLog& record,
                  const RefinementOptions& wanted = {});

}  // namespace lodeline
