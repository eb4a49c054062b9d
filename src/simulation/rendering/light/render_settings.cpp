#include "simulation/rendering/light/render_settings.h"

namespace lodeline {
namespace {

/// Two video lamps on arms, left and right above the cameras, rotated a little outwards.
std::vector<Lamp> twoVideoLamps() {
  std::vector<Lamp> lamps;
  for (const double side : {1.0, -1.0}) {
    Lamp lamp;
    lamp.position_B = Vec3(0.10, 0.42 * side, 0.22);
    lamp.direction_B = Vec3(1.0, 0.16 * side, 0.05).normalized();
    lamp.spot_intensity = 5.0;
    lamp.spot_half_angle_rad = 0.20;
    lamp.flood_intensity = 5.0;
    lamp.flood_half_angle_rad = 0.75;
    lamps.push_back(lamp);
  }
  return lamps;
}

}  // namespace

void RenderSettings::mountLamps(const Rigid3& diver_from_body) {
  const Rigid3 body_from_diver = diver_from_body.inverse();
  for (Lamp& lamp : lamps) {
    lamp.position_B = body_from_diver * lamp.position_B;
    lamp.direction_B = body_from_diver.rotation * lamp.direction_B;
  }
}

RenderSettings RenderSettings::clean() {
  RenderSettings settings;
  settings.lamps = twoVideoLamps();
  return settings;
}

RenderSettings RenderSettings::field() {
  RenderSettings settings = clean();
  settings.water.attenuation_per_m = 0.33;
  settings.water.scattering_share = 0.75;
  settings.water.patchiness = 0.4;
  settings.snow.flakes_per_m3 = 350.0;
  settings.snow.median_radius_m = 0.00017;
  settings.second_diver = SecondDiver{};
  settings.sensor.longest_exposure_s = 0.022;
  settings.sensor.gain_flicker = 0.015;
  settings.sensor.read_noise_e = 8.0;
  // Real lamps differ: one is darker.
  settings.lamps[1].spot_intensity *= 0.7;
  settings.lamps[1].flood_intensity *= 0.7;
  return settings;
}

RenderSettings RenderSettings::openWater() {
  RenderSettings settings = clean();
  settings.daylight.irradiance = 0.9;
  settings.water.attenuation_per_m = 0.16;
  return settings;
}

RenderSettings RenderSettings::room() {
  RenderSettings settings;
  settings.daylight.irradiance = 12.0;
  settings.water.attenuation_per_m = 0.0;
  settings.snow.flakes_per_m3 = 0.0;
  return settings;
}

RenderSettings RenderSettings::ideal() {
  RenderSettings settings = clean();
  settings.snow.flakes_per_m3 = 0.0;
  settings.sensor.noise = false;
  settings.motion_blur = false;
  return settings;
}

}  // namespace lodeline
