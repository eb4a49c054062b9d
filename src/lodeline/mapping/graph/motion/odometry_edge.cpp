#include "lodeline/mapping/graph/motion/odometry_edge.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {

void OdometryFloor::check() const {
  const double least = std::min({position_m_per_sqrt_m, rotation_rad_per_sqrt_m, least_path_m});
  if (!(least > 0.0)) throw UsageError("the least uncertainty of odometry must be positive");
}

Mat6 OdometryFloor::covariance(double path_m) const {
  const double path = std::max(path_m, least_path_m);
  Vec6 variances;
  variances.head<3>().setConstant(position_m_per_sqrt_m * position_m_per_sqrt_m * path);
  variances.tail<3>().setConstant(rotation_rad_per_sqrt_m * rotation_rad_per_sqrt_m * path);
  return variances.asDiagonal();
}

namespace {

/// Eigenvalues of a change of the covariance relative to the floor, as `count` takes them, and at least one.
template <typename Count>
Mat6 raisedTo(const Mat6& floor, const Mat6& growth, const Count& count) {
  const Vec6 sigmas = floor.diagonal().cwiseSqrt();
  const Vec6 inverse = sigmas.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Mat6> relative(inverse.asDiagonal() * growth * inverse.asDiagonal());
  const Mat6 axes = sigmas.asDiagonal() * relative.eigenvectors();
  return axes * relative.eigenvalues().unaryExpr(count).cwiseMax(1.0).asDiagonal() * axes.transpose();
}

void checkOdometry(const MapKeyframe& keyframe) {
  const std::string what = fmt::format("keyframe {}", keyframe.id);
  checkPose(keyframe.odom_from_body, what.c_str());
  if (!keyframe.covariance.allFinite()) {
    throw InputError(what + ": the covariance of its odometry is not finite");
  }
}

/// The relative pose with the change of the covariance between both.
template <typename Count>
RelativePose relativePose(const MapKeyframe& previous, const MapKeyframe& next, double path_m,
                          const OdometryFloor& floor, const Count& count) {
  floor.check();
  checkOdometry(previous);
  checkOdometry(next);
  if (previous.dive != next.dive) {
    throw InputError(fmt::format("keyframes {} and {} are of the dives {} and {}; odometry connects one dive",
                                 previous.id, next.id, previous.dive, next.dive));
  }
  const Vec3 way_W = next.odom_from_body.translation - previous.odom_from_body.translation;
  Mat6 carried = Mat6::Identity();  // A
  carried.topRightCorner<3, 3>() = -so3::skew(way_W);
  Mat6 to_body = Mat6::Zero();  // diag(R^T, R^T)
  to_body.topLeftCorner<3, 3>() = previous.odom_from_body.rotation.conjugate().toRotationMatrix();
  to_body.bottomRightCorner<3, 3>() = to_body.topLeftCorner<3, 3>();

  const Mat6 growth_W = next.covariance - carried * previous.covariance * carried.transpose();
  const Mat6 symmetric_W = 0.5 * (growth_W + growth_W.transpose());
  return {previous.odom_from_body.inverse() * next.odom_from_body,
          raisedTo(floor.covariance(std::max(path_m, way_W.norm())),
                   to_body * symmetric_W * to_body.transpose(), count)};
}

}  // namespace

RelativePose odometryEdge(const MapKeyframe& previous, const MapKeyframe& next, double path_m,
                          const OdometryFloor& floor) {
  return relativePose(previous, next, path_m, floor, [](double growth) { return growth; });
}

RelativePose odometryFactor(const MapKeyframe& previous, const MapKeyframe& next,
                            const OdometryFloor& floor) {
  return relativePose(previous, next, 0.0, floor, [](double growth) { return std::abs(growth); });
}

}  // namespace lodeline
