#pragma once

#include "simulation/rendering/light/light_field.h"
#include "simulation/rendering/light/render_settings.h"

namespace lodeline {

/// The lamps that are on and the water at a time, for a true pose of the rig.
LightField placeLight(const RenderSettings& settings, const CameraOptics& optics,
                      const Rigid3& world_from_body, double time_s);

}  // namespace lodeline
