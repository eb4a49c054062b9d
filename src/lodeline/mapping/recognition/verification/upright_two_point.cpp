#include "lodeline/mapping/recognition/verification/upright_two_point.h"

#include <cmath>

namespace lodeline {
namespace {

/// Rays closer to each other than this angle, rad, and differences of points closer to the vertical, relative
/// to their length, leave yaw undetermined.
constexpr double kLeastAngle_rad = 0.02;

}  // namespace

std::vector<Rigid3> posesOfTwoPoints(const PointOnRay& first, const PointOnRay& second) {
  const Vec3 normal = first.bearing_T.cross(second.bearing_T);
  const Vec3 between_points = first.point_S - second.point_S;
  const Vec3 between_origins = first.origin_T - second.origin_T;
  const double a = normal.head<2>().dot(between_points.head<2>());
  const double b = normal.y() * between_points.x() - normal.x() * between_points.y();
  const double c = normal.dot(between_origins) - normal.z() * between_points.z();
  const double length = std::hypot(a, b);
  if (normal.norm() < kLeastAngle_rad || length <= kLeastAngle_rad * normal.norm() * between_points.norm() ||
      std::abs(c) > length) {
    return {};
  }
  std::vector<Rigid3> poses;
  const double middle_rad = std::atan2(b, a), half_rad = std::acos(c / length);
  for (const double yaw_rad : {middle_rad + half_rad, middle_rad - half_rad}) {
    const Quat rotation(Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ()));
    // lambda_1 b_1 - lambda_2 b_2 = R (p_1 - p_2) - (o_1 - o_2), which lies in the plane of both rays.
    const Vec3 difference = rotation * between_points - between_origins;
    const double cosine = first.bearing_T.dot(second.bearing_T), sine2 = normal.squaredNorm();
    const double along_first = first.bearing_T.dot(difference),
                 along_second = second.bearing_T.dot(difference);
    const double distance_first = (along_first - cosine * along_second) / sine2;
    const double distance_second = (cosine * along_first - along_second) / sine2;
    if (distance_first <= 0.0 || distance_second <= 0.0) continue;
    const Vec3 by_first = first.origin_T + distance_first * first.bearing_T - rotation * first.point_S;
    const Vec3 by_second = second.origin_T + distance_second * second.bearing_T - rotation * second.point_S;
    poses.emplace_back(rotation, 0.5 * (by_first + by_second));
  }
  return poses;
}

}  // namespace lodeline
