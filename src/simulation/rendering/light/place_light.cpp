#include "simulation/rendering/light/place_light.h"

namespace lodeline {

LightField placeLight(const RenderSettings& settings, const CameraOptics& optics,
                      const Rigid3& world_from_body, double time_s) {
  LightField light{{}, settings.daylight, Water(settings.water, time_s, settings.seed)};
  for (const Lamp& lamp : settings.lamps) light.lamps.emplace_back(lamp, world_from_body);
  if (settings.second_diver) {
    const Vec3 forward = world_from_body.rotation * (optics.bodyFromCamera().rotation * Vec3::UnitZ());
    const auto torch =
        placeSecondDiver(*settings.second_diver, world_from_body.translation, forward, time_s, settings.seed);
    if (torch) light.lamps.push_back(*torch);
  }
  return light;
}

}  // namespace lodeline
