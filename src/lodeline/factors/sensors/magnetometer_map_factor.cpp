#include "lodeline/factors/sensors/magnetometer_map_factor.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>

#include "lodeline/diagnostics.h"
#include "lodeline/factors/sensors/magnetometer_field_factor.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

Vec3 turnedAboutVertical(double angle_rad, const Vec3& vector) {
  return Eigen::AngleAxisd(angle_rad, Vec3::UnitZ()) * vector;
}

}  // namespace

MagnetometerMapFactor::MagnetometerMapFactor(const Vec3& reading_B, const Vec3& mapped_M,
                                             const Mat3& covariance_W, const Quat& reference,
                                             const double* first_pose, const double* first_heading)
    : reading_B_(reading_B),
      mapped_M_(mapped_M),
      reference_(reference),
      first_pose_(first_pose),
      first_heading_(first_heading) {
  const Eigen::LLT<Mat3> root(covariance_W);
  if (!reading_B.allFinite() || !mapped_M.allFinite() || !covariance_W.allFinite() ||
      root.info() != Eigen::Success) {
    throw InputError(
        fmt::format("a magnetometer reading of ({}, {}, {}) T cannot be weighed against a map of the field",
                    reading_B.x(), reading_B.y(), reading_B.z()));
  }
  const Mat3 lower = root.matrixL();
  whitening_ = lower.triangularView<Eigen::Lower>().solve(Mat3::Identity());
}

bool MagnetometerMapFactor::Evaluate(double const* const* parameters, double* residuals,
                                     double** jacobians) const {
  const double psi = headingBetween(reference_, poseFromBlock(parameters[0]).rotation);
  const Vec3 measured_W = turnedAboutVertical(psi, reference_ * reading_B_);
  Eigen::Map<Vec3>(residuals).noalias() =
      whitening_ * (measured_W - turnedAboutVertical(parameters[1][0], mapped_M_));
  if (jacobians == nullptr) return true;
  // With linearization points, the map's field replaces the measurement in both. The common yaw of poses and
  // map then stays exactly in the null space.
  const Vec3 mapped_W = turnedAboutVertical(first_heading_ ? *first_heading_ : parameters[1][0], mapped_M_);
  if (jacobians[0] != nullptr) {
    const double* pose = first_pose_ != nullptr ? first_pose_ : parameters[0];
    const Vec3 seen_W = first_heading_ != nullptr ? mapped_W : measured_W;
    const Vec3 difference = so3::log(poseFromBlock(pose).rotation * reference_.conjugate());
    const Vec3 psi_by_rotation = so3::rightJacobianInverse(-difference).row(2).transpose();
    Eigen::Map<Eigen::Matrix<double, 3, kPoseSize, Eigen::RowMajor>> by_pose(jacobians[0]);
    by_pose.setZero();
    by_pose.middleCols<3>(3) = whitening_ * Vec3::UnitZ().cross(seen_W) * psi_by_rotation.transpose();
  }
  if (jacobians[1] != nullptr)
    Eigen::Map<Vec3>(jacobians[1]).noalias() = -whitening_ * Vec3::UnitZ().cross(mapped_W);
  return true;
}

}  // namespace lodeline
