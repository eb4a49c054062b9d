#pragma once

#include <ceres/sized_cost_function.h>

#include "lodeline/factors/parameters.h"

namespace lodeline {

/// Measured position m_W of a point l_B of the body, with covariance C in world axes:
///   r = L^-1 (p + R_WB l_B - m_W),   C = L L^T.
class PositionFactor final : public ceres::SizedCostFunction<3, kPoseSize> {
 public:
  PositionFactor(const Vec3& position_W, const Mat3& covariance, const Vec3& point_B);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Vec3 position_W_, point_B_;
  Mat3 whitening_;  ///< L^-1
};

}  // namespace lodeline
