#pragma once

#include <memory>

#include "simulation/dive/dive.h"
#include "simulation/rendering/image_renderer.h"

namespace lodeline {

/// The rendered world of a dive for cameras and sonar; nothing where the scenario has none.
std::shared_ptr<const RenderWorld> buildWorld(const Dive& dive);

/// Settings of light, water, lens and sensor for the scenario's effects.
RenderSettings renderSettings(const Dive& dive);

/// Time intervals of stirred-up silt: 3 to 8 s every minute or two.
std::vector<SiltEpisode> drawSiltOuts(double duration_s, uint64_t seed);

}  // namespace lodeline
