#pragma once

#include "simulation/rendering/cave/solid_texture.h"
#include "simulation/rendering/cave/traced_scene.h"
#include "simulation/rendering/light/light_field.h"

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
  /// The surfaces that a packet met, lane by lane so that the compiler can work on several at once. Lanes
  /// without a hit hold a black surface.
  struct Lit {
    float point[3][kRayPacketSize];
    float normal[3][kRayPacketSize];  ///< with the small relief, facing the camera
    float reflectance[kRayPacketSize];
    float gloss[kRayPacketSize];
  };

  void describe(const RayPacket& rays, const HitPacket& hits, int i, float pixel_angle_rad, bool detail,
                Lit& lit) const;
  /// `attenuation` (1/m) is the diffuse one: light that the water scatters forwards still falls on the rock.
  void addLamp(const RayPacket& rays, const Lit& lit, const PlacedLamp& lamp, float attenuation,
               float* radiance) const;

  const TracedScene& scene_;
  const SolidTexture& texture_;
};

}  // namespace lodeline
