#pragma once

#include <ceres/sized_cost_function.h>

#include "lodeline/factors/parameters.h"

namespace lodeline {

/// Heading in a world of odometry whose azimuth a in the world of the graph is a parameter:
///   r = (azimuth(R_WB R_OB^T) - a) / sigma,
/// wrapped to half a turn. The azimuth of a rotation is its twist about z, see azimuthOf().
/// Parameters: pose of the body, azimuth (rad).
class HeadingFactor final : public ceres::SizedCostFunction<1, kPoseSize, 1> {
 public:
  HeadingFactor(const Quat& odom_from_body, double sigma_rad);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Quat body_from_odom_;
  double sigma_rad_;
};

}  // namespace lodeline
