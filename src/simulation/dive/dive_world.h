#pragma once

#include <memory>

#include "simulation/dive/dive.h"
#include "simulation/rendering/image_renderer.h"

namespace lodeline {

/// The place of a dive as cameras and sonar see it. Nothing where the scenario has none.
std::shared_ptr<const RenderWorld> buildWorld(const Dive& dive);

/// Light, water, lens and chip as the scenario's effects have them.
RenderSettings renderSettings(const Dive& dive);

/// Stretches of stirred-up silt: 3 to 8 s every minute or two.
std::vector<SiltEpisode> drawSiltOuts(double duration_s, uint64_t seed);

}  // namespace lodeline
