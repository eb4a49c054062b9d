#pragma once

#include <optional>
#include <vector>

#include "lodeline/mapping/cloud/cloud_index.h"
#include "lodeline/mapping/cloud/local_cloud.h"

namespace lodeline {

/// Distance of a point from the surface of a cloud, in the frame of that cloud:
///
///   r = n . (q - c),   sigma^2 = n' S n + (t^2 - s^2) + h t^2.
///
/// q is the point with its covariance S; c, n, t and h are centroid, normal, thickness and leverage of the
/// plane through the points nearest to q. s^2 is the part of the thickness that the noise of these points
/// explains; the rest (at least zero) is roughness, which q has too. All positions in m.
struct SurfaceDistance {
  double distance_m = 0.0;
  double sigma_m = 0.0;
  Vec3 normal = Vec3::UnitZ();
  Mat3 tilt_covariance = Mat3::Zero();  ///< of the normal
  Vec3 view = Vec3::Zero();             ///< viewing vector of the surface's points, m
};

/// The surface that the points of a cloud lie on.
class CloudSurface {
 public:
  CloudSurface(const LocalCloud& cloud, int neighbours);

  /// Distance of a point; `normal` is its own, zero where unknown. Empty where the surface ends or is no
  /// plane, and where both normals differ by more than 60 degrees: the other side of a ledge.
  std::optional<SurfaceDistance> at(const Vec3& place, const Vec3& normal, const Mat3& covariance) const;

  /// Median of the thickness over the points with a normal, m; zero without any.
  double thickness_m() const { return thickness_m_; }

 private:
  const LocalCloud& cloud_;
  CloudIndex index_;
  int neighbours_;
  double thickness_m_ = 0.0;
  mutable std::vector<Neighbour> work_;
};

}  // namespace lodeline
