#pragma once

#include <vector>

#include "simulation/rendering/light/light_field.h"

namespace lodeline {

/// Effect of the water on the light between a surface and the camera.
struct HazeSample {
  float transmittance = 1.0f;  ///< fraction of the surface's radiance that arrives
  float radiance = 0.0f;       ///< light of the lamps scattered into the ray, W/m^2/sr
};

/// Light scattered into the rays of a coarse grid over the image, accumulated over distance:
///   L(r) = integral_0^r  b(x) * sum_l p(angle_l) * E_l(x) * exp(-tau'(x))  dx
/// E_l is the lamp's attenuated irradiance, p the phase function and tau' the diffuse optical depth from
/// the camera, see Water::Coefficients. Source of the single scattering that it extends: S.
/// Chandrasekhar, "Radiative Transfer", 1950, section 7. Haze is smooth over the image: a node every
/// sixteen pixels is enough.
class HazeVolume {
 public:
  static constexpr int kNodeSpacing_px = 16;

  /// `directions_W` are unit rays of the nodes from `origin_W`, row by row.
  HazeVolume(const LightField& light, const Vec3f& origin_W, const std::vector<Vec3f>& directions_W,
             int columns);

  /// Haze at a pixel and a distance along its ray.
  HazeSample at(float x_px, float y_px, float range_m) const;

 private:
  static constexpr int kSteps = 32;
  struct Entry {
    float optical_depth = 0.0f;
    float radiance = 0.0f;
  };

  void march(const LightField& light, const Vec3f& origin_W, const Vec3f& direction_W, Entry* entries) const;

  int columns_;
  int rows_;
  float step_range_m_[kSteps];
  std::vector<Entry> entries_;  ///< kSteps entries per node
};

}  // namespace lodeline
