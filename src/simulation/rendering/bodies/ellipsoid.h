#pragma once

#include <vector>

#include "lodeline/types.h"
#include "simulation/rendering/cave/traced_scene.h"

namespace lodeline {

/// An ellipsoid that is a moving part of a fish or of a diver. Its skin has a pattern in its axes: x forward,
/// y left, z up.
struct BodyPart {
  Rigid3 world_from_part;
  Vec3 half_axes_m = Vec3::Ones();
  float back_reflectance = 0.2f;    ///< albedo above
  float belly_reflectance = 0.2f;   ///< albedo below
  float contrast = 0.0f;            ///< of stripes and spots, 0..1
  float stripes_per_length = 0.0f;  ///< across x; 0: spots only
  float gloss = 0.0f;
  uint32_t seed = 0;
};

/// An ellipsoid at one moment, single precision.
class PlacedEllipsoid {
 public:
  explicit PlacedEllipsoid(const BodyPart& part);

  const Vec3f& centre() const { return centre_W_; }
  float boundingRadius() const { return bounding_radius_m_; }

  /// Distance along a unit direction to the first point from outside; infinite without one within `most_m`.
  float range(const Vec3f& origin_W, const Vec3f& direction_W, float most_m) const;

  /// Normal and skin at a point of the surface.
  SurfacePoint surfaceAt(const Vec3f& point_W) const;

 private:
  Mat3f part_from_world_;  ///< rotation
  Vec3f centre_W_, half_axes_m_, inverse_axes_;
  float bounding_radius_m_;
  float back_, belly_, contrast_, stripes_, gloss_;
  uint32_t seed_;
};

/// Replaces hits of the scene by nearer ones of the bodies.
void intersectBodies(const std::vector<PlacedEllipsoid>& bodies, const RayPacket& rays, HitPacket& hits);

/// Bit mask of the rays that a body occludes within their range.
uint32_t occludedByBodies(const std::vector<PlacedEllipsoid>& bodies, const RayPacket& rays);

}  // namespace lodeline
