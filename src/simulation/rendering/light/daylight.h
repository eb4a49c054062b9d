#pragma once

#include <optional>

#include "lodeline/types.h"
#include "simulation/rendering/optics/fast_exp.h"
#include "simulation/rendering/optics/render_types.h"

namespace lodeline {

/// Light from the water surface: everywhere in open water, or from a cave's entrance with exponential decay.
struct Daylight {
  double irradiance = 0.0;         ///< on a surface facing the light, W/m^2 in the lamps' units
  std::optional<Vec3> entrance_W;  ///< position of the entrance; nothing for open water
  double decay_m = 6.0;            ///< distance from the entrance over which it decays to 1/e

  bool none() const { return irradiance <= 0.0; }

  /// Diffuse light on a surface (W/m^2): strongest on surfaces that face up (open water) or the entrance.
  float onSurface(const Vec3f& point_W, const Vec3f& normal_W) const {
    if (none()) return 0.0f;
    Vec3f from = Vec3f::UnitZ();
    float strength = static_cast<float>(irradiance);
    if (entrance_W) {
      from = entrance_W->cast<float>() - point_W;
      const float distance = from.norm();
      from /= std::max(distance, 1e-3f);
      strength *= fastExp(-distance / static_cast<float>(decay_m));
    }
    return strength * (0.55f + 0.45f * normal_W.dot(from));
  }

  /// Mean light at a point in the water, W/m^2.
  float inWater(const Vec3f& point_W) const { return none() ? 0.0f : onSurface(point_W, Vec3f::Zero()); }
};

}  // namespace lodeline
