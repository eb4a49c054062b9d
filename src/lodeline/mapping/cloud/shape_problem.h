#pragma once

#include <vector>

#include "lodeline/mapping/cloud/cloud_surface.h"

namespace lodeline {

using Vec4 = Eigen::Matrix<double, 4, 1>;
using Mat4 = Eigen::Matrix<double, 4, 4>;
using Vec5 = Eigen::Matrix<double, 5, 1>;
using Mat5 = Eigen::Matrix<double, 5, 5>;
using Mat46 = Eigen::Matrix<double, 4, 6>;

/// What is known of the pose before shapes are compared, on the four parameters of a registration: position
/// of the new cloud's centroid in the old frame (m) and yaw about the old frame's vertical (rad).
struct ShapePrior {
  Rigid3 old_from_new;  ///< predicted, with both verticals parallel
  Mat4 covariance = Mat4::Identity();
};

/// Pose of the new cloud, and how much farther from its camera the new surface lies everywhere. The offset
/// takes up the curvature of the walls, which planes cut, and the scale of distances across.
struct ShapeState {
  Rigid3 old_from_new;
  double offset_m = 0.0;
};

/// One point of the new cloud on the old surface, linearized by [centroid, yaw, offset]:
///
///   e = (n . (q - c) + offset) / sigma,   J = [n', up . (a x n), 1] / sigma,   a = q - centroid.
///
/// Normals point towards the cameras, so that a surface farther away has a negative distance.
struct ShapeRow {
  size_t point = 0;    ///< of the new cloud
  double error = 0.0;  ///< in sigmas
  Vec5 jacobian = Vec5::Zero();
  Mat4 slope_noise = Mat4::Zero();  ///< covariance of the first four of the Jacobian, from the normal's tilt
  /// Derivatives of the error by the relative scale of old and new distances and by the tilt about two
  /// horizontal axes of the old frame: parameters that are not estimated.
  Vec4 considered = Vec4::Zero();
};

/// Registration of a new cloud to an old one with four degrees of freedom.
class ShapeProblem {
 public:
  /// Both clouds must outlive the problem.
  ShapeProblem(const LocalCloud& old_cloud, const LocalCloud& new_cloud, int neighbours);
  ShapeProblem(const LocalCloud&& old_cloud, const LocalCloud& new_cloud, int neighbours) = delete;
  ShapeProblem(const LocalCloud& old_cloud, const LocalCloud&& new_cloud, int neighbours) = delete;

  /// Rows of every `stride`-th point that has a counterpart.
  std::vector<ShapeRow> rows(const ShapeState& state, size_t stride = 1) const;

  /// The state after a step of [centroid, yaw, offset].
  ShapeState moved(const ShapeState& state, const Vec5& step) const;

  /// Difference of two poses as [centroid, yaw]: `to` relative to `from`.
  Vec4 difference(const Rigid3& from, const Rigid3& to) const;

  /// Derivative of [centroid, yaw] by [dp, dtheta] of the pose, in axes of the old frame.
  Mat46 parametersByPose(const Rigid3& old_from_new) const;

  /// A pose turned by the least angle that makes both verticals parallel. `tilt_rad` becomes that angle.
  Rigid3 upright(const Rigid3& old_from_new, double& tilt_rad) const;

  size_t size() const { return new_.points.size(); }
  const LocalCloud& newCloud() const { return new_; }
  const LocalCloud& oldCloud() const { return old_; }
  const Vec3& centroid_N() const { return centroid_N_; }

 private:
  const LocalCloud& old_;
  const LocalCloud& new_;
  CloudSurface surface_;
  Vec3 centroid_N_ = Vec3::Zero();
  Mat32 horizontal_;  ///< two horizontal axes of the old frame
};

}  // namespace lodeline
