#pragma once

#include "simulation/dive/dive.h"

namespace lodeline {

/// Draws what moves in the water of a dive, and the layers of the water: current, fish, buddy and halocline,
/// as far as the scenario has them. Needs the dive's motion.
void addLife(Dive& dive);

}  // namespace lodeline
