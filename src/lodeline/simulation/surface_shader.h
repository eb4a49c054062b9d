#pragma once

#include "lodeline/simulation/light_field.h"
#include "lodeline/simulation/solid_texture.h"
#include "lodeline/simulation/traced_scene.h"

namespace lodeline {

/// Radiance that surfaces send towards the camera, before the water in between.
class SurfaceShader {
 public:
  SurfaceShader(const TracedScene& scene, const SolidTexture& texture) : scene_(scene), texture_(texture) {}

  /// Radiance (W/m^2/sr) of every hit of a packet; `pixel_angle_rad` is the angle between neighbouring rays.
  /// Without `detail` the small texture is left out, as a light meter does. Zero where nothing was hit.
  void shade(const RayPacket& rays, const HitPacket& hits, const LightField& light, float pixel_angle_rad,
             bool detail, float* radiance) const;

 private:
  struct Lit {
    Vec3f point;
    Vec3f normal;  ///< with the small relief, facing the camera
    float reflectance = 0.0f;
    float gloss = 0.0f;
  };

  Lit surface(const RayPacket& rays, const HitPacket& hits, int i, float pixel_angle_rad, bool detail) const;

  const TracedScene& scene_;
  const SolidTexture& texture_;
};

}  // namespace lodeline
