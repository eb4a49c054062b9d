#pragma once

#include <optional>
#include <vector>

#include "lodeline/mapping/cloud/cloud_index.h"
#include "lodeline/mapping/cloud/local_cloud.h"

namespace lodeline {

/// Plane through the points of a cloud around a place, by weighted principal components.
struct LocalPlane {
  Vec3 centroid = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();          ///< unit, towards the cameras that saw the points
  double thickness_squared_m2 = 0.0;    ///< variance of the points about the plane
  double noise_squared_m2 = 0.0;        ///< part of that from the covariances of the points
  Mat3 tilt_covariance = Mat3::Zero();  ///< of the normal
  /// Variance of the plane at the place, as a multiple of the thickness squared. It grows beyond the points.
  double leverage = 0.0;
  double flatness = 0.0;     ///< 1 for a plane, 0 where the points spread as much across as along
  Vec3 view = Vec3::Zero();  ///< weighted mean of the points' viewing vectors, m
};

/// Fits the plane to the `count` points nearest to a place. The weights fall to zero at the farthest of them,
/// (1 - d^2 / d_max^2)^2, so that the plane changes smoothly with the place. Empty with fewer than six points
/// or where they lie on a line. D. Levin, "Mesh-independent surface interpolation", 2003, has the projection
/// onto such planes.
std::optional<LocalPlane> fitLocalPlane(const LocalCloud& cloud, const CloudIndex& index, const Vec3& place,
                                        int count, std::vector<Neighbour>& work);

}  // namespace lodeline
