#include "lodeline/mapping/graph/motion/relative_pose.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <limits>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {

RelativePose composed(const RelativePose& a_from_b, const RelativePose& b_from_c) {
  const Mat3 R = a_from_b.from_from_to.rotation.toRotationMatrix();
  Mat6 by_first = Mat6::Identity(), by_second = Mat6::Zero();
  by_first.topRightCorner<3, 3>() = -so3::skew(R * b_from_c.from_from_to.translation);
  by_second.topLeftCorner<3, 3>() = R;
  by_second.bottomRightCorner<3, 3>() = R;
  return {a_from_b.from_from_to * b_from_c.from_from_to,
          by_first * a_from_b.covariance * by_first.transpose() +
              by_second * b_from_c.covariance * by_second.transpose()};
}

RelativePose inverted(const RelativePose& pose) {
  const Mat3 inverse_R = pose.from_from_to.rotation.conjugate().toRotationMatrix();
  Mat6 by_error = Mat6::Zero();
  by_error.topLeftCorner<3, 3>() = -inverse_R;
  by_error.topRightCorner<3, 3>() = -inverse_R * so3::skew(pose.from_from_to.translation);
  by_error.bottomRightCorner<3, 3>() = -inverse_R;
  return {pose.from_from_to.inverse(), by_error * pose.covariance * by_error.transpose()};
}

Vec6 errorBetween(const Rigid3& estimate, const Rigid3& truth) {
  Vec6 error;
  error << truth.translation - estimate.translation, so3::log(truth.rotation * estimate.rotation.conjugate());
  return error;
}

double mahalanobisSquared(const Rigid3& estimate, const Rigid3& truth, const Mat6& covariance) {
  const Eigen::LLT<Mat6> factor(covariance);
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  return factor.matrixL().solve(errorBetween(estimate, truth)).squaredNorm();
}

void checkCovariance(const Eigen::Ref<const Eigen::MatrixXd>& covariance, const char* what) {
  if (!covariance.allFinite()) throw InputError(fmt::format("{}: its covariance is not finite", what));
  if ((covariance - covariance.transpose()).norm() > 1e-6 * covariance.norm()) {
    throw InputError(fmt::format("{}: its covariance is not symmetric", what));
  }
  if (Eigen::LLT<Eigen::MatrixXd>(covariance).info() != Eigen::Success) {
    throw InputError(fmt::format("{}: its covariance is not positive definite", what));
  }
}

void checkPose(const Rigid3& pose, const char* what) {
  if (!pose.translation.allFinite() || !pose.rotation.coeffs().allFinite()) {
    throw InputError(fmt::format("{}: the pose is not finite", what));
  }
  if (std::abs(pose.rotation.norm() - 1.0) > 1e-6) {
    throw InputError(
        fmt::format("{}: the quaternion has the length {:g} instead of 1", what, pose.rotation.norm()));
  }
}

}  // namespace lodeline
