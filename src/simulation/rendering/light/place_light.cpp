#include "simulation/rendering/light/place_light.h"

namespace lodeline {
namespace {

constexpr float kFarthestBody_m = 8.0f;

PlacedLamp placeTorch(const Buddy& buddy, double time_s) {
  const TorchPose pose = torchOf(buddy, time_s);
  Lamp torch;
  torch.position_B = pose.position_W;
  torch.direction_B = pose.direction_W;
  torch.spot_intensity = buddy.spot_intensity;
  torch.spot_half_angle_rad = buddy.spot_half_angle_rad;
  torch.flood_intensity = 0.05 * buddy.spot_intensity;
  return PlacedLamp(torch, Rigid3());
}

Lamp dimmed(Lamp lamp, double strength) {
  lamp.spot_intensity *= strength;
  lamp.flood_intensity *= strength;
  return lamp;
}

}  // namespace

LightField placeLight(const RenderSettings& settings, const CameraOptics& optics,
                      const Rigid3& world_from_body, double time_s) {
  LightField light{{}, settings.daylight, Water(settings.water, time_s, settings.seed)};
  for (const Lamp& lamp : settings.lamps) {
    const double strength = lamp.strength ? lamp.strength(time_s) : 1.0;
    if (strength > 0.0) light.lamps.emplace_back(dimmed(lamp, strength), world_from_body);
  }
  if (settings.second_diver) {
    const Vec3 forward = world_from_body.rotation * (optics.bodyFromCamera().rotation * Vec3::UnitZ());
    const auto torch =
        placeSecondDiver(*settings.second_diver, world_from_body.translation, forward, time_s, settings.seed);
    if (torch) light.lamps.push_back(*torch);
  }
  placeFish(settings.fish, settings.snow.current.get(), time_s, light.bodies);
  if (settings.buddy) {
    placeBuddy(*settings.buddy, time_s, light.bodies);
    light.lamps.push_back(placeTorch(*settings.buddy, time_s));
  }
  const Vec3f here = world_from_body.translation.cast<float>();
  std::erase_if(light.bodies, [&](const PlacedEllipsoid& body) {
    return (body.centre() - here).norm() - body.boundingRadius() > kFarthestBody_m;
  });
  return light;
}

}  // namespace lodeline
