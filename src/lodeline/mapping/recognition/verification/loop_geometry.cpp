#include "lodeline/mapping/recognition/verification/loop_geometry.h"

#include <cmath>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// Tangent of the largest angle between prediction and ray. Sigmas of directions are below a degree.
constexpr double kWidestTangent = 0.1;
/// Relative sigma of a distance beyond which its error is not normal: the inverse distance is.
constexpr double kLinearDistance = 0.25;
/// Relative sigma of a distance beyond which the position says no more than the ray.
constexpr double kUnknownDistance = 1.0 / 3.0;

}  // namespace

PointObservation observationOf(const MapFeature& feature) {
  const BodyRay& ray = feature.rays.front();
  PointObservation observation;
  observation.origin_B = ray.origin_B;
  observation.bearing_B = ray.bearing_B;
  observation.tangent_B = tangentBasis(ray.bearing_B);
  observation.sigma_rad = ray.sigma_rad;
  if (!feature.point_B) return observation;
  observation.point_B = *feature.point_B;
  observation.distance_m = (observation.point_B - ray.origin_B).norm();
  observation.distance_sigma_m = feature.distance_sigma_m;
  if (!(observation.distance_m > 0.0) || !(observation.relativeSigma() < kUnknownDistance))
    return observation;
  observation.has_point = true;
  const Mat3 along = ray.bearing_B * ray.bearing_B.transpose();
  observation.covariance = std::pow(observation.distance_sigma_m, 2) * along +
                           std::pow(ray.sigma_rad * observation.distance_m, 2) * (Mat3::Identity() - along);
  return observation;
}

std::optional<LoopCorrespondence> correspondenceOf(const MapKeyframe& old_keyframe,
                                                   const MapKeyframe& new_keyframe,
                                                   const FeatureMatch& match) {
  LoopCorrespondence pair;
  pair.match = match;
  pair.in_old = observationOf(old_keyframe.features[static_cast<size_t>(match.old_feature)]);
  pair.in_new = observationOf(new_keyframe.features[static_cast<size_t>(match.new_feature)]);
  if (!pair.in_old.has_point && !pair.in_new.has_point) return std::nullopt;
  pair.is_point_old = pair.in_old.has_point &&
                      (!pair.in_new.has_point || pair.in_old.relativeSigma() <= pair.in_new.relativeSigma());
  return pair;
}

LoopResidual residualOf(const LoopCorrespondence& pair, const Rigid3& old_from_new, bool with_jacobian) {
  const PointObservation& ray = pair.ray();
  const PointObservation& seen = pair.point();
  LoopResidual residual;
  // The point in axes of the ray's body.
  const Mat3 old_rotation_new = old_from_new.rotation.toRotationMatrix();
  const Mat3 rotation = pair.is_point_old ? Mat3(old_rotation_new.transpose()) : old_rotation_new;
  const Vec3 moved = pair.is_point_old ? Vec3(seen.point_B - old_from_new.translation) : seen.point_B;
  const Vec3 turned = rotation * moved;
  const Vec3 q = (pair.is_point_old ? turned : Vec3(turned + old_from_new.translation)) - ray.origin_B;
  const double z = ray.bearing_B.dot(q);
  if (z <= 0.0) return residual;
  const Vec2 direction = ray.tangent_B.transpose() * q / z;
  if (direction.squaredNorm() > kWidestTangent * kWidestTangent) return residual;
  residual.is_valid = true;
  const bool with_distance = ray.has_point && ray.relativeSigma() < kLinearDistance;
  residual.rows = with_distance ? 3 : 2;

  Mat3 by_q;
  by_q.topRows<2>() = (ray.tangent_B.transpose() - direction * ray.bearing_B.transpose()) / z;
  by_q.row(2) = ray.bearing_B.transpose();
  const Mat3 carried = by_q * rotation;
  Mat3 covariance = carried * seen.covariance * carried.transpose();
  const double ray_variance = ray.sigma_rad * ray.sigma_rad;
  covariance.diagonal() +=
      Vec3(ray_variance, ray_variance, with_distance ? std::pow(ray.distance_sigma_m, 2) : 1.0);
  residual.direction_area_sr = std::sqrt(covariance.topLeftCorner<2, 2>().determinant());

  // The lower factor of the leading rows does not depend on the last one, which is dropped without a
  // distance.
  const Mat3 lower = covariance.llt().matrixL();
  const Vec3 error(direction.x(), direction.y(), with_distance ? z - ray.distance_m : 0.0);
  const auto whiten = lower.triangularView<Eigen::Lower>();
  residual.whitened = whiten.solve(error);
  if (!with_distance) residual.whitened.z() = 0.0;
  if (!with_jacobian) return residual;
  Eigen::Matrix<double, 3, 6> q_by_pose;
  if (pair.is_point_old) {
    q_by_pose << -rotation, rotation * so3::skew(moved);
  } else {
    q_by_pose << Mat3::Identity(), -so3::skew(turned);
  }
  residual.by_pose = whiten.solve(by_q * q_by_pose);
  if (!with_distance) residual.by_pose.row(2).setZero();
  return residual;
}

double gateOf(int rows) { return rows == 2 ? 9.21 : 11.34; }

bool isInlier(const LoopResidual& residual) {
  return residual.is_valid && residual.squared() <= gateOf(residual.rows);
}

Vec3 upInBody(const MapKeyframe& keyframe) {
  return keyframe.odom_from_body.rotation.conjugate() * Vec3::UnitZ();
}

double tiltSigma_rad(const MapKeyframe& a, const MapKeyframe& b) {
  // Share of errors that the covariances do not contain: the extrinsics' drift between two dives.
  constexpr double kFloor_rad = 0.004;
  const double variance =
      0.5 * (a.covariance.block<2, 2>(3, 3).trace() + b.covariance.block<2, 2>(3, 3).trace());
  return std::sqrt(variance + kFloor_rad * kFloor_rad);
}

}  // namespace lodeline
