#include "lodeline/factors/interpolated_pose.h"

#include <utility>
#include <vector>

#include "lodeline/geometry/so3.h"

namespace lodeline {

PoseInterpolation::PoseInterpolation(const Rigid3& before, const Rigid3& pose, const Rigid3& after,
                                     double share, const Interval& interval)
    : share_(share),
      interval_(interval),
      bow_per_acceleration_s2_(0.5 * share * (1.0 - share) * interval.elapsed_s * interval.elapsed_s),
      bow_B_(before.rotation.conjugate() *
             Vec3(pose.translation - (1.0 - share) * before.translation - share * after.translation +
                  bow_per_acceleration_s2_ * interval.gravity_W)),
      before_from_this_(before.rotation.conjugate() * pose.rotation),
      before_from_after_(before.rotation.conjugate() * after.rotation) {}

Vec3 PoseInterpolation::closing_W(const Rigid3& before, const Rigid3& after) const {
  return so3::log(after.rotation * (before.rotation * before_from_after_).conjugate());
}

Vec3 PoseInterpolation::turningBow_W(const Rigid3& before,
                                     const AccelerometerCalibration& accelerometer) const {
  const AccelerometerCalibration& then = interval_.accelerometer;
  const SensorAxes axes_since = accelerometer.axes - then.axes;
  const Vec3 since_B = bow_per_acceleration_s2_ * (accelerometer.bias_B - then.bias_B) +
                       Eigen::Map<const Mat3>(axes_since.data()) * bow_B_;
  return before.rotation * Vec3(bow_B_ + since_B);
}

Rigid3 PoseInterpolation::pose(const Rigid3& before, const Rigid3& after,
                               const AccelerometerCalibration& accelerometer) const {
  const Quat rotation = so3::exp(share_ * closing_W(before, after)) * before.rotation * before_from_this_;
  return Rigid3(rotation.normalized(), (1.0 - share_) * before.translation + share_ * after.translation +
                                           turningBow_W(before, accelerometer) -
                                           bow_per_acceleration_s2_ * interval_.gravity_W);
}

PoseInterpolation::Derivatives PoseInterpolation::derivatives(
    const Rigid3& before, const Rigid3& after, const AccelerometerCalibration& accelerometer) const {
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
  by.by_before.topRightCorner<3, 3>() = -so3::skew(turningBow_W(before, accelerometer));
  by.by_before.bottomRightCorner<3, 3>() =
      so3::exp(share_ * closing_W).toRotationMatrix() - by_closing * so3::exp(closing_W).toRotationMatrix();
  const Mat3 world_from_before = before.rotation.toRotationMatrix();
  by.by_bias = bow_per_acceleration_s2_ * world_from_before;
  for (int i = 0; i < 3; ++i) by.by_axes.middleCols<3>(3 * i) = bow_B_[i] * world_from_before;
  return by;
}

InterpolatedPoseFactor::InterpolatedPoseFactor(std::unique_ptr<ceres::CostFunction> factor, size_t pose_block,
                                               const PoseInterpolation& interpolation, bool has_axes,
                                               const InterpolationFirstEstimates& first)
    : factor_(std::move(factor)),
      pose_block_(pose_block),
      interpolation_(interpolation),
      has_axes_(has_axes),
      first_(first) {
  set_num_residuals(factor_->num_residuals());
  *mutable_parameter_block_sizes() = factor_->parameter_block_sizes();
  for (const int size : {kPoseSize, kMotionSize}) mutable_parameter_block_sizes()->push_back(size);
  if (has_axes_) mutable_parameter_block_sizes()->push_back(SensorAxes::SizeAtCompileTime);
}

bool InterpolatedPoseFactor::Evaluate(double const* const* parameters, double* residuals,
                                      double** jacobians) const {
  using ByPose = Eigen::Matrix<double, Eigen::Dynamic, kPoseSize, Eigen::RowMajor>;
  using ByNine = Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor>;
  const size_t after = factor_->parameter_block_sizes().size(), motion = after + 1, axes = motion + 1;
  const auto at = [&](size_t block, const double* first) { return first ? first : parameters[block]; };
  const auto accelerometer = [&](const InterpolationFirstEstimates& first) {
    AccelerometerCalibration calibration{Vec3(at(motion, first.motion) + kAccelerometerBiasInMotion)};
    if (has_axes_) calibration.axes = SensorAxes(at(axes, first.axes));
    return calibration;
  };
  double pose[kPoseSize];
  poseToBlock(interpolation_.pose(poseFromBlock(parameters[pose_block_]), poseFromBlock(parameters[after]),
                                  accelerometer({})),
              pose);
  std::vector<const double*> inner(parameters, parameters + after);
  inner[pose_block_] = pose;
  if (!jacobians) return factor_->Evaluate(inner.data(), residuals, nullptr);
  std::vector<double*> inner_jacobians(jacobians, jacobians + after);
  ByPose by_pose(num_residuals(), kPoseSize);
  inner_jacobians[pose_block_] = by_pose.data();
  if (!factor_->Evaluate(inner.data(), residuals, inner_jacobians.data())) return false;
  const PoseInterpolation::Derivatives by =
      interpolation_.derivatives(poseFromBlock(at(pose_block_, first_.before)),
                                 poseFromBlock(at(after, first_.after)), accelerometer(first_));
  for (const auto& [block, by_neighbour] :
       {std::pair(pose_block_, &by.by_before), std::pair(after, &by.by_after)}) {
    if (!jacobians[block]) continue;
    Eigen::Map<ByPose> jacobian(jacobians[block], num_residuals(), kPoseSize);
    jacobian.setZero();
    jacobian.leftCols<kPoseTangentSize>() = by_pose.leftCols<kPoseTangentSize>() * *by_neighbour;
  }
  if (jacobians[motion]) {
    Eigen::Map<ByNine> jacobian(jacobians[motion], num_residuals(), kMotionSize);
    jacobian.setZero();
    jacobian.middleCols<3>(kAccelerometerBiasInMotion) = by_pose.leftCols<3>() * by.by_bias;
  }
  if (has_axes_ && jacobians[axes]) {
    Eigen::Map<ByNine>(jacobians[axes], num_residuals(), 9) = by_pose.leftCols<3>() * by.by_axes;
  }
  return true;
}

}  // namespace lodeline
