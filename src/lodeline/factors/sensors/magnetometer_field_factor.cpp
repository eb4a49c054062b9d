#include "lodeline/factors/sensors/magnetometer_field_factor.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <utility>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using Vec3Map = Eigen::Map<const Vec3>;
using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// Lower triangular W with W^T W = covariance^-1.
Mat3 whiteningOf(const Mat3& covariance) {
  const Mat3 lower = covariance.llt().matrixL();
  return lower.triangularView<Eigen::Lower>().solve(Mat3::Identity());
}

}  // namespace

double headingBetween(const Quat& reference, const Quat& rotation) {
  return so3::log(rotation * reference.conjugate()).z();
}

Mat3 fieldCovariance_W(const Vec3& field_W, const FieldNoise& noise) {
  const Mat3 by_rotation = so3::skew(field_W);
  Vec3 variances = Vec3::Constant(noise.rotation_sigma_rad * noise.rotation_sigma_rad);
  variances.head<2>().array() += noise.tilt_sigma_rad * noise.tilt_sigma_rad;
  Mat3 covariance = by_rotation * variances.asDiagonal() * by_rotation.transpose();
  covariance.diagonal().array() += noise.sigma_T * noise.sigma_T;
  return covariance;
}

MagnetometerFieldFactor::MagnetometerFieldFactor(const Vec3& mean_B, const Mat3& carried,
                                                 const Quat& reference, const Vec3& field_W,
                                                 const FieldNoise& noise, bool disturbed,
                                                 const double* first_pose, const double* first_field,
                                                 std::vector<double> currents_A)
    : mean_B_(mean_B),
      carried_(carried),
      reference_(reference),
      disturbed_(disturbed),
      first_pose_(first_pose),
      first_field_(first_field),
      currents_A_(std::move(currents_A)) {
  const Mat3 covariance = fieldCovariance_W(field_W, noise);
  if (!mean_B.allFinite() || !covariance.allFinite() || !(noise.sigma_T > 0.0)) {
    throw InputError(fmt::format("a magnetometer mean of ({}, {}, {}) T with sigma {} T cannot be weighed",
                                 mean_B.x(), mean_B.y(), mean_B.z(), noise.sigma_T));
  }
  whitening_ = whiteningOf(covariance);
  set_num_residuals(3);
  *mutable_parameter_block_sizes() = {kPoseSize, 3, 3};
  if (disturbed) mutable_parameter_block_sizes()->push_back(3);
  mutable_parameter_block_sizes()->insert(mutable_parameter_block_sizes()->end(), currents_A_.size(), 3);
}

bool MagnetometerFieldFactor::Evaluate(double const* const* parameters, double* residuals,
                                       double** jacobians) const {
  const auto turned = [this](const double* pose) {
    const double psi = headingBetween(reference_, poseFromBlock(pose).rotation);
    return Quat(so3::exp(psi * Vec3::UnitZ()) * reference_);
  };
  const Vec3 field_W = Vec3Map(parameters[1]) + (disturbed_ ? Vec3(Vec3Map(parameters[3])) : Vec3::Zero());
  Vec3 on_board_B = Vec3Map(parameters[2]);
  const size_t first_current = disturbed_ ? 4 : 3;
  for (size_t i = 0; i < currents_A_.size(); ++i)
    on_board_B += currents_A_[i] * Vec3Map(parameters[first_current + i]);
  const Vec3 measured_W = turned(parameters[0]) * (mean_B_ - carried_ * on_board_B);
  Eigen::Map<Vec3>(residuals).noalias() = whitening_ * (measured_W - field_W);
  if (jacobians == nullptr) return true;

  const double* pose = first_pose_ != nullptr ? first_pose_ : parameters[0];
  if (jacobians[0] != nullptr) {
    // With linearization points, that of the field replaces the measurement in world axes. The common yaw of
    // poses and field then stays exactly in the null space.
    const Vec3 seen_W = first_field_ != nullptr ? Vec3(Vec3Map(first_field_)) : measured_W;
    const Vec3 difference = so3::log(poseFromBlock(pose).rotation * reference_.conjugate());
    const Vec3 psi_by_rotation = so3::rightJacobianInverse(-difference).row(2).transpose();
    Eigen::Map<Eigen::Matrix<double, 3, kPoseSize, Eigen::RowMajor>> by_pose(jacobians[0]);
    by_pose.setZero();
    by_pose.middleCols<3>(3) = whitening_ * Vec3::UnitZ().cross(seen_W) * psi_by_rotation.transpose();
  }
  const auto write = [&](size_t block, const Mat3& jacobian) {
    if (jacobians[block] != nullptr) Eigen::Map<RowMajor3>{jacobians[block]} = jacobian;
  };
  write(1, -whitening_);
  const Mat3 by_offset = -whitening_ * turned(pose).toRotationMatrix() * carried_;
  write(2, by_offset);
  if (disturbed_) write(3, -whitening_);
  for (size_t i = 0; i < currents_A_.size(); ++i) write(first_current + i, currents_A_[i] * by_offset);
  return true;
}

}  // namespace lodeline
