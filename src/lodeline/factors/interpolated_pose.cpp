#include "lodeline/factors/interpolated_pose.h"

#include <utility>
#include <vector>

#include "lodeline/geometry/so3.h"

namespace lodeline {

PoseInterpolation::PoseInterpolation(const Rigid3& before, const Rigid3& pose, const Rigid3& after,
                                     double share)
    : share_(share),
      bow_B_(before.rotation.conjugate() *
             Vec3(pose.translation - (1.0 - share) * before.translation - share * after.translation)),
      before_from_this_(before.rotation.conjugate() * pose.rotation),
      before_from_after_(before.rotation.conjugate() * after.rotation) {}

Vec3 PoseInterpolation::closing_W(const Rigid3& before, const Rigid3& after) const {
  return so3::log(after.rotation * (before.rotation * before_from_after_).conjugate());
}

Rigid3 PoseInterpolation::pose(const Rigid3& before, const Rigid3& after) const {
  const Quat rotation = so3::exp(share_ * closing_W(before, after)) * before.rotation * before_from_this_;
  return Rigid3(rotation.normalized(),
                (1.0 - share_) * before.translation + share_ * after.translation + before.rotation * bow_B_);
}

PoseInterpolation::Derivatives PoseInterpolation::derivatives(const Rigid3& before,
                                                              const Rigid3& after) const {
  const Vec3 closing_W = this->closing_W(before, after);
  // log(exp(d) exp(v)) = v + J_l^-1(v) d, with J_l^-1(v) = J_r^-1(-v).
  const Mat3 by_closing =
      share_ * so3::leftJacobian(share_ * closing_W) * so3::rightJacobianInverse(-closing_W);
  Derivatives by;
  by.by_after.setZero();
  by.by_after.topLeftCorner<3, 3>() = share_ * Mat3::Identity();
  by.by_after.bottomRightCorner<3, 3>() = by_closing;
  by.by_before.setZero();
  by.by_before.topLeftCorner<3, 3>() = (1.0 - share_) * Mat3::Identity();
  by.by_before.topRightCorner<3, 3>() = -so3::skew(before.rotation * bow_B_);
  by.by_before.bottomRightCorner<3, 3>() =
      so3::exp(share_ * closing_W).toRotationMatrix() - by_closing * so3::exp(closing_W).toRotationMatrix();
  return by;
}

InterpolatedPoseFactor::InterpolatedPoseFactor(std::unique_ptr<ceres::CostFunction> factor, size_t pose_block,
                                               const PoseInterpolation& interpolation,
                                               const double* first_before, const double* first_after)
    : factor_(std::move(factor)),
      pose_block_(pose_block),
      interpolation_(interpolation),
      first_before_(first_before),
      first_after_(first_after) {
  set_num_residuals(factor_->num_residuals());
  *mutable_parameter_block_sizes() = factor_->parameter_block_sizes();
  mutable_parameter_block_sizes()->push_back(kPoseSize);
}

bool InterpolatedPoseFactor::Evaluate(double const* const* parameters, double* residuals,
                                      double** jacobians) const {
  using ByPose = Eigen::Matrix<double, Eigen::Dynamic, kPoseSize, Eigen::RowMajor>;
  const size_t after = parameter_block_sizes().size() - 1;
  const auto at = [&](size_t block, const double* first) {
    return poseFromBlock(first ? first : parameters[block]);
  };
  double pose[kPoseSize];
  poseToBlock(interpolation_.pose(at(pose_block_, nullptr), at(after, nullptr)), pose);
  std::vector<const double*> inner(parameters, parameters + after);
  inner[pose_block_] = pose;
  if (!jacobians) return factor_->Evaluate(inner.data(), residuals, nullptr);
  std::vector<double*> inner_jacobians(jacobians, jacobians + after);
  ByPose by_pose(num_residuals(), kPoseSize);
  inner_jacobians[pose_block_] = by_pose.data();
  if (!factor_->Evaluate(inner.data(), residuals, inner_jacobians.data())) return false;
  const PoseInterpolation::Derivatives by =
      interpolation_.derivatives(at(pose_block_, first_before_), at(after, first_after_));
  for (const auto& [block, by_neighbour] :
       {std::pair(pose_block_, &by.by_before), std::pair(after, &by.by_after)}) {
    if (!jacobians[block]) continue;
    Eigen::Map<ByPose> jacobian(jacobians[block], num_residuals(), kPoseSize);
    jacobian.setZero();
    jacobian.leftCols<kPoseTangentSize>() = by_pose.leftCols<kPoseTangentSize>() * *by_neighbour;
  }
  return true;
}

}  // namespace lodeline
