#include "simulation/rendering/light/lamp.h"

#include <cmath>

namespace lodeline {

PlacedLamp::PlacedLamp(const Lamp& lamp, const Rigid3& world_from_body)
    : position_W_((world_from_body * lamp.position_B).cast<float>()),
      direction_W_((world_from_body.rotation * lamp.direction_B.normalized()).cast<float>()),
      spot_(static_cast<float>(lamp.spot_intensity)),
      per_spot_(static_cast<float>(1.0 / (1.0 - std::cos(lamp.spot_half_angle_rad)))),
      flood_(static_cast<float>(lamp.flood_intensity)),
      per_flood_(static_cast<float>(1.0 / (1.0 - std::cos(lamp.flood_half_angle_rad)))) {}

}  // namespace lodeline
