#pragma once

#include <functional>
#include <vector>

#include "lodeline/types.h"
#include "simulation/rendering/optics/fast_exp.h"
#include "simulation/rendering/optics/render_types.h"

namespace lodeline {

/// A diving lamp on the rig: the spot of a reflector inside a wide flood. Radiant units are arbitrary but
/// consistent.
struct Lamp {
  Vec3 position_B = Vec3::Zero();     ///< m
  Vec3 direction_B = Vec3::UnitX();   ///< unit
  double spot_intensity = 0.0;        ///< on the axis, W/sr
  double spot_half_angle_rad = 0.16;  ///< angle of half intensity
  double flood_intensity = 0.0;       ///< on the axis, W/sr
  double flood_half_angle_rad = 0.70;
  std::function<double(double time_s)> strength = {};  ///< share of the intensities; empty: always 1
};

/// A lamp with its world pose at one moment.
class PlacedLamp {
 public:
  PlacedLamp(const Lamp& lamp, const Rigid3& world_from_body);

  const Vec3f& position() const { return position_W_; }

  /// Radiant intensity (W/sr) in a direction given by the cosine of its angle to the axis. Both parts
  /// decrease with x = (1 - cos(angle)) / (1 - cos(half angle)), close to the square of the angle. The spot
  /// follows 2^-x, a Gaussian; the flood follows 2^(-x^2), flat with a soft edge.
  float intensity(float cosine) const {
    const float off_axis = 1.0f - cosine;
    const float flood_x = off_axis * per_flood_;
    return spot_ * fastExp2(-off_axis * per_spot_) + flood_ * fastExp2(-flood_x * flood_x);
  }

  /// Irradiance of a surface facing the lamp in empty space, W/m^2: intensity towards a point divided by the
  /// squared distance. `towards_lamp` is the unit vector from the point, `distance` in m.
  float irradiance(const Vec3f& towards_lamp, float distance_m) const {
    return intensity(-towards_lamp.dot(direction_W_)) / (distance_m * distance_m);
  }

 private:
  Vec3f position_W_;
  Vec3f direction_W_;
  float spot_, per_spot_, flood_, per_flood_;
};

}  // namespace lodeline
