#pragma once

#include <ceres/sized_cost_function.h>

#include "lodeline/factors/parameters.h"

namespace lodeline {

/// Roll and pitch: the direction of up in the body, u_B, measured with sigma about each horizontal axis.
///   u = R_WB u_B,   r = (alpha / sin alpha) [u_x, u_y] / sigma,   alpha = angle between u and z.
/// |r| sigma is that angle up to pi. At a half turn its direction is undefined and r is zero.
class TiltFactor final : public ceres::SizedCostFunction<2, kPoseSize> {
 public:
  TiltFactor(const Vec3& up_B, double sigma_rad);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Vec3 up_B_;
  double sigma_rad_;
};

}  // namespace lodeline
