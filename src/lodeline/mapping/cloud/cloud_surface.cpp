#include "lodeline/mapping/cloud/cloud_surface.h"

#include <algorithm>
#include <cmath>

#include "lodeline/geometry/squared.h"
#include "lodeline/mapping/cloud/local_plane.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

/// Beyond the points, the variance of the plane exceeds that of the points about it.
constexpr double kMostLeverage = 1.0;
constexpr double kLeastSurfaceFlatness = 0.5;
constexpr double kLeastCosine = 0.5;
/// Degrees of freedom of the thickness of one plane: about seven effective neighbours less three.
constexpr double kThicknessFreedom = 4.0;

CloudIndex indexOf(const LocalCloud& cloud) {
  std::vector<Vec3> positions;
  for (const CloudPoint& point : cloud.points) positions.push_back(point.position_F);
  return CloudIndex(std::move(positions));
}

}  // namespace

CloudSurface::CloudSurface(const LocalCloud& cloud, int neighbours)
    : cloud_(cloud), index_(indexOf(cloud)), neighbours_(neighbours) {
  std::vector<double> thicknesses;
  for (const CloudPoint& point : cloud.points) {
    if (!point.normal_F.isZero()) thicknesses.push_back(point.thickness_m);
  }
  thickness_m_ = median(std::move(thicknesses));
}

std::optional<SurfaceDistance> CloudSurface::at(const Vec3& place, const Vec3& normal,
                                                const Mat3& covariance) const {
  const auto plane = fitLocalPlane(cloud_, index_, place, neighbours_, work_);
  if (!plane || plane->flatness < kLeastSurfaceFlatness || plane->leverage > kMostLeverage)
    return std::nullopt;
  if (!normal.isZero() && normal.dot(plane->normal) < kLeastCosine) return std::nullopt;
  // Few neighbours say little of their own thickness: half of it is that of the whole cloud.
  const double thickness_squared =
      (kThicknessFreedom * plane->thickness_squared_m2 + kThicknessFreedom * squared(thickness_m_)) /
      (2.0 * kThicknessFreedom);
  SurfaceDistance result;
  result.distance_m = plane->normal.dot(place - plane->centroid);
  const double roughness_squared = std::max(0.0, thickness_squared - plane->noise_squared_m2);
  result.sigma_m = std::sqrt(plane->normal.dot(covariance * plane->normal) + roughness_squared +
                             thickness_squared * plane->leverage + 1e-8);
  result.normal = plane->normal;
  result.tilt_covariance = plane->tilt_covariance;
  result.view = plane->view;
  return result;
}

}  // namespace lodeline
