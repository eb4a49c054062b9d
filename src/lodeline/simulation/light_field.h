#pragma once

#include <vector>

#include "lodeline/simulation/daylight.h"
#include "lodeline/simulation/lamp.h"
#include "lodeline/simulation/water.h"

namespace lodeline {

/// All light and the water it crosses, at one moment.
struct LightField {
  std::vector<PlacedLamp> lamps;
  Daylight daylight;
  Water water;
};

}  // namespace lodeline
