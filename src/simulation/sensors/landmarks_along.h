#pragma once

#include <cstdint>

#include "simulation/sensors/landmark_field.h"
#include "simulation/shared/motion.h"

namespace lodeline {

/// Points 2 to 6 m from the path, seen from there: images then have enough of them along the whole path.
LandmarkField landmarksAlong(const Motion& motion, uint64_t seed);

}  // namespace lodeline
