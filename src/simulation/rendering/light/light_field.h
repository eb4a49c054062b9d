#pragma once

#include <vector>

#include "simulation/rendering/bodies/ellipsoid.h"
#include "simulation/rendering/light/daylight.h"
#include "simulation/rendering/light/lamp.h"
#include "simulation/rendering/light/water.h"

namespace lodeline {

/// All lamps, the daylight, the water and the moving bodies in it at one moment.
struct LightField {
  std::vector<PlacedLamp> lamps;
  Daylight daylight;
  Water water;
  std::vector<PlacedEllipsoid> bodies = {};
};

}  // namespace lodeline
