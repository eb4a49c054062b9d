#pragma once

#include <ceres/evaluation_callback.h>
#include <ceres/problem.h>

#include <deque>
#include <memory>
#include <vector>

#include "lodeline/factors/prior_factor.h"
#include "lodeline/imu/preintegration.h"
#include "lodeline/rig_calibration/problem/rig_state.h"

namespace lodeline {

/// What a solution keeps as it is.
struct FixedParameters {
  bool lens = false;
  bool port = false;
};

/// Integrals of the inertial readings from each frame to the next; null where there is none.
using InertialLinks = std::vector<std::unique_ptr<Preintegration>>;

/// Places of one camera's parameters in the covariance of a Posterior; -1 for fixed ones.
struct CameraColumns {
  int lens = -1, port = -1, extrinsics = -1, delay = -1;
};

/// Covariance of the calibration. Frames and motion are eliminated.
struct Posterior {
  Eigen::MatrixXd covariance;          ///< of the tangent coordinates, by CameraColumns
  std::vector<CameraColumns> columns;  ///< per camera
  /// Largest ratio of a sigma from the scatter of the frames' gradients to that from the curvature.
  double largest_inflation = 1.0;
};

/// The least-squares problem of a calibration: a robust error for every corner and, with links, an inertial
/// factor between frames, with priors on biases and ports.
class RigProblem final : public ceres::EvaluationCallback {
 public:
  /// `state` and `links` must outlive the problem. No links: cameras alone.
  RigProblem(RigState* state, const CalibrationBoard& board, const FixedParameters& fixed,
             const InertialLinks& links);
  ~RigProblem() override;

  /// Levenberg-Marquardt. Throws EstimationError where the solver fails.
  void solve(int most_steps);

  /// Standard deviations after a solution. The curvature of the cost gives the covariance. Errors that a
  /// frame's corners have in common make it too small: where the scatter of the frames' gradients gives more
  /// (P. J. Huber, "The behavior of maximum likelihood estimates under nonstandard conditions", 1967), that
  /// counts.
  Posterior posterior();

  /// Mean squared sigma of the inertial residuals, per degree of freedom; 0 without links.
  double inertialVariance();

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override;

 private:
  void addCorners(const CalibrationBoard& board);
  void addLinks(const InertialLinks& links);
  void addPortPriors(bool keeps_lens);
  void settleConstants(const FixedParameters& fixed, bool has_links);

  RigState* state_;
  std::unique_ptr<ceres::Problem> problem_;
  std::deque<Prior> priors_;
  std::vector<ceres::ResidualBlockId> inertial_, without_frame_;
  std::vector<std::vector<ceres::ResidualBlockId>> by_frame_;
};

}  // namespace lodeline
