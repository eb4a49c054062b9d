#include "lodeline/factors/sensors/magnetometer_relative_factor.h"

#include <fmt/core.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {

MagnetometerRelativeFactor::MagnetometerRelativeFactor(const Vec3& newest_B, const Vec3& mean_Bk,
                                                       int readings, double sigma_T,
                                                       const double* first_pose_k,
                                                       const double* first_pose_k1)
    : newest_B_(newest_B),
      mean_Bk_(mean_Bk),
      weight_(std::sqrt(static_cast<double>(readings)) / sigma_T),
      first_pose_k_(first_pose_k),
      first_pose_k1_(first_pose_k1) {
  if (!newest_B.allFinite() || !mean_Bk.allFinite() || readings < 1 || !(sigma_T > 0.0)) {
    throw InputError(
        fmt::format("{} magnetometer readings with a sigma of {} T cannot be weighed", readings, sigma_T));
  }
}

bool MagnetometerRelativeFactor::Evaluate(double const* const* parameters, double* residuals,
                                          double** jacobians) const {
  const Quat body_k_from_world = poseFromBlock(parameters[0]).rotation.conjugate();
  const Quat world_from_body_k1 = poseFromBlock(parameters[1]).rotation;
  Eigen::Map<Vec3>(residuals).noalias() =
      weight_ * (body_k_from_world * (world_from_body_k1 * newest_B_) - mean_Bk_);
  if (jacobians == nullptr) return true;

  const double* pose_k = first_pose_k_ != nullptr ? first_pose_k_ : parameters[0];
  const double* pose_k1 = first_pose_k1_ != nullptr ? first_pose_k1_ : parameters[1];
  // Both rotations rotate the same world vector, in opposite directions.
  const Mat3 by_rotation_k = weight_ * poseFromBlock(pose_k).rotation.conjugate().toRotationMatrix() *
                             so3::skew(poseFromBlock(pose_k1).rotation * newest_B_);
  for (int i = 0; i < 2; ++i) {
    if (jacobians[i] == nullptr) continue;
    Eigen::Map<Eigen::Matrix<double, 3, kPoseSize, Eigen::RowMajor>> by_pose(jacobians[i]);
    by_pose.setZero();
    by_pose.middleCols<3>(3) = i == 0 ? by_rotation_k : Mat3(-by_rotation_k);
  }
  return true;
}

}  // namespace lodeline
