#pragma once

#include "simulation/rendering/cave/solid_texture.h"
#include "simulation/rendering/cave/traced_scene.h"
#include "simulation/rendering/light/light_field.h"

namespace lodeline {

/// Computes the radiance from surfaces towards the camera, before attenuation by the water.
class SurfaceShader {
 public:
  /// The texture is fixed to `texture_origin_W`.
  SurfaceShader(const TracedScene& scene, const SolidTexture& texture, const Vec3f& texture_origin_W)
      : scene_(scene), texture_(texture), texture_origin_W_(texture_origin_W) {}

  /// Radiance (W/m^2/sr) of every hit of a packet; `pixel_angle_rad` is the angle between neighbouring rays.
  /// Without `detail`, the small-scale texture is omitted, as for a light meter. Zero without a hit.
  void shade(const RayPacket& rays, const HitPacket& hits, const LightField& light, float pixel_angle_rad,
             bool detail, float* radiance) const;

 private:
  /// Surfaces hit by a packet, stored by lane so that the compiler can vectorize. Lanes without a hit have a
  /// black surface.
  struct Lit {
    float point[3][kRayPacketSize];
    float normal[3][kRayPacketSize];  ///< includes the small-scale relief, facing the camera
    float reflectance[kRayPacketSize];
    float gloss[kRayPacketSize];
  };

  void describe(const RayPacket& rays, const HitPacket& hits, int i, float pixel_angle_rad, bool detail,
                const LightField& light, Lit& lit) const;
  /// Adds the light of one lamp. The attenuation is the diffuse one, because light scattered forwards still
  /// reaches the surface.
  void addLamp(const RayPacket& rays, const Lit& lit, const PlacedLamp& lamp, const LightField& light,
               float* radiance) const;

  const TracedScene& scene_;
  const SolidTexture& texture_;
  Vec3f texture_origin_W_;
};

}  // namespace lodeline
