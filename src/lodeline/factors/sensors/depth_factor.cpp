#include "lodeline/factors/sensors/depth_factor.h"

#include <fmt/core.h>

#include <cmath>

#include "lodeline/diagnostics.h"

namespace lodeline {

DepthFactor::DepthFactor(const CarriedDepth& depth, const Vec3& port_B_m, double sigma_m,
                         const double* first_pose, const double* first_scale)
    : depth_(depth),
      port_B_(port_B_m),
      sigma_m_(sigma_m),
      first_pose_(first_pose),
      first_scale_(first_scale) {
  if (!std::isfinite(depth.depth_m) || !std::isfinite(depth.rise_m) ||
      !std::isfinite(depth.rise_by_lag_m_per_s) || !(sigma_m > 0.0) || !std::isfinite(sigma_m)) {
    throw InputError(fmt::format("a depth of {} m, risen {} m since, with sigma {} m cannot be weighed",
                                 depth.depth_m, depth.rise_m, sigma_m));
  }
  set_num_residuals(1);
  *mutable_parameter_block_sizes() = {kPoseSize, 1, 1, 1};
}

bool DepthFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const auto arm = [this](const double* pose) { return Vec3(poseFromBlock(pose).rotation * port_B_); };
  const double scale = parameters[2][0];
  const double rise_m = depth_.rise_m + depth_.rise_by_lag_m_per_s * (parameters[3][0] - depth_.lag_s);
  const double height_m = parameters[0][2] + arm(parameters[0]).z() - rise_m;
  residuals[0] = (depth_.depth_m - parameters[1][0] + scale * height_m) / sigma_m_;
  if (jacobians == nullptr) return true;

  const double first_scale = first_scale_ != nullptr ? *first_scale_ : scale;
  const double* pose = first_pose_ != nullptr ? first_pose_ : parameters[0];
  const Vec3 arm_W = arm(pose);
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 1, kPoseSize>> by_pose(jacobians[0]);
    by_pose << 0.0, 0.0, 1.0, arm_W.y(), -arm_W.x(), 0.0, 0.0;
    by_pose *= first_scale / sigma_m_;
  }
  if (jacobians[1] != nullptr) jacobians[1][0] = -1.0 / sigma_m_;
  if (jacobians[2] != nullptr) jacobians[2][0] = (pose[2] + arm_W.z() - rise_m) / sigma_m_;
  if (jacobians[3] != nullptr) jacobians[3][0] = -first_scale * depth_.rise_by_lag_m_per_s / sigma_m_;
  return true;
}

}  // namespace lodeline
