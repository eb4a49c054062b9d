#pragma once

#include <ceres/sized_cost_function.h>

#include "lodeline/factors/parameters.h"

namespace lodeline {

/// A landmark at x_W seen from a body, measured as s_B with covariance C in body axes:
///   r = L^-1 (R_WB^T (x_W - p) - s_B),   C = L L^T.
/// Parameters: pose of the body, position of the landmark.
class LandmarkObservationFactor final : public ceres::SizedCostFunction<3, kPoseSize, 3> {
 public:
  LandmarkObservationFactor(const Vec3& point_B, const Mat3& covariance);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Vec3 point_B_;
  Mat3 whitening_;  ///< L^-1
};

}  // namespace lodeline
