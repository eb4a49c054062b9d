#pragma once

#include <vector>

#include "simulation/rendering/light/daylight.h"
#include "simulation/rendering/light/lamp.h"
#include "simulation/rendering/light/water.h"

namespace lodeline {

/// All lamps, the daylight and the water at one moment.
struct LightField {
  std::vector<PlacedLamp> lamps;
  Daylight daylight;
  Water water;
};

}  // namespace lodeline
