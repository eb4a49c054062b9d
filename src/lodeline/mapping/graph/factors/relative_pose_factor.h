#pragma once

#include <ceres/sized_cost_function.h>

#include "lodeline/factors/parameters.h"
#include "lodeline/mapping/graph/motion/relative_pose.h"

namespace lodeline {

/// Relative pose of two bodies, measured as (R, p) with the covariance C of its error in axes of `from`:
///   r = L^-1 [R_i^T (p_j - p_i) - p;  log(R_i^T R_j R^T)],   C = L L^T.
/// Parameters: pose of `from` (i) and pose of `to` (j), see parameters.h.
class RelativePoseFactor final : public ceres::SizedCostFunction<6, kPoseSize, kPoseSize> {
 public:
  explicit RelativePoseFactor(const RelativePose& measured);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Rigid3 from_from_to_;
  Mat6 whitening_;  ///< L^-1
};

}  // namespace lodeline
