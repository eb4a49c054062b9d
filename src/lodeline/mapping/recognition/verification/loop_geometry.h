#pragma once

#include <optional>
#include <vector>

#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// What one keyframe knows about a point: a ray and, where it is known, the position on it.
struct PointObservation {
  Vec3 origin_B = Vec3::Zero();
  Vec3 bearing_B = Vec3::UnitZ();
  Mat32 tangent_B = Mat32::Identity();  ///< basis of the plane normal to the bearing
  double sigma_rad = 1e-3;
  bool has_point = false;
  Vec3 point_B = Vec3::Zero();
  double distance_m = 0.0;  ///< from the origin
  double distance_sigma_m = 0.0;
  Mat3 covariance = Mat3::Zero();  ///< of the point, m^2

  double relativeSigma() const { return distance_sigma_m / distance_m; }
};
PointObservation observationOf(const MapFeature& feature);

/// A match whose residual depends on the pose: at least one of both observations has a position.
struct LoopCorrespondence {
  FeatureMatch match;
  PointObservation in_old, in_new;
  /// Whether the position comes from the old keyframe and the ray from the new one, or the reverse.
  bool is_point_old = true;

  const PointObservation& ray() const { return is_point_old ? in_new : in_old; }
  const PointObservation& point() const { return is_point_old ? in_old : in_new; }
};

/// Correspondence of a match; empty where neither feature has a position. Where both have one, the more
/// accurate position is compared with the other ray, and the distances are compared too.
std::optional<LoopCorrespondence> correspondenceOf(const MapKeyframe& old_keyframe,
                                                   const MapKeyframe& new_keyframe,
                                                   const FeatureMatch& match);

/// Difference between the measurements of one point by two keyframes. With the predicted point q = (x, y, z)
/// in axes of the ray (z along the bearing b) and relative to its origin,
///
///     e = (x / z, y / z)   and, where the ray's keyframe knows the distance d,   e_3 = z - d.
///
/// The covariance of e is that of the ray, diag(s^2, s^2, s_d^2), plus that of q, carried over by de/dq. Its
/// Cholesky factor whitens e and the Jacobian; it counts as constant.
struct LoopResidual {
  bool is_valid = false;  ///< the point is in front of the ray and within 6 degrees of it
  int rows = 2;           ///< 2 or 3
  Vec3 whitened = Vec3::Zero();
  Eigen::Matrix<double, 3, 6> by_pose = Eigen::Matrix<double, 3, 6>::Zero();  ///< by [dp, dtheta], whitened
  double direction_area_sr = 0.0;  ///< of the one-sigma ellipse of the direction, divided by pi

  double squared() const { return whitened.head(rows).squaredNorm(); }
};
/// Residual at a pose; with the Jacobian by [dp, dtheta] of Loop where `with_jacobian`.
LoopResidual residualOf(const LoopCorrespondence& pair, const Rigid3& old_from_new, bool with_jacobian);

/// Whether a correspondence agrees with a pose: its residual is within the ellipsoid that contains 99 % of
/// normal errors.
bool isInlier(const LoopResidual& residual);
/// Squared radius of that ellipsoid for a number of rows.
double gateOf(int rows);

/// Direction of the vertical in a keyframe's body, unit.
Vec3 upInBody(const MapKeyframe& keyframe);
/// Standard deviation of the angle, about each horizontal axis, between the verticals of two keyframes, rad.
double tiltSigma_rad(const MapKeyframe& a, const MapKeyframe& b);

}  // namespace lodeline
