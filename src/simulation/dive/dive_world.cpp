#include "simulation/dive/dive_world.h"

#include <cmath>

#include "simulation/dive/vehicle_dive.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

Daylight entranceLight(const Centerline& passage) {
  Daylight daylight;
  daylight.irradiance = 6.0;
  // The entrance is behind the diver, at the start of the passage.
  daylight.entrance_W = passage.at(passage.beginArcLength()).position_W;
  daylight.decay_m = 3.5;
  return daylight;
}

// Dives of one cave differ in the clarity of the water, the snow and the lamps.
void drawSeason(const EffectSet& on, uint64_t seed, RenderSettings& settings) {
  Random random(seed, "season");
  const double clarity = random.uniform(0.75, 1.3), patches = random.uniform(0.5, 1.5);
  const double flakes = random.uniform(0.4, 2.0), radius = random.uniform(0.85, 1.15);
  if (on.has(Effect::MilkyWater)) {
    settings.water.attenuation_per_m *= clarity;
    settings.water.patchiness *= patches;
    settings.snow.flakes_per_m3 *= flakes;
    settings.snow.median_radius_m *= radius;
  }
  for (Lamp& lamp : settings.lamps) {
    const double strength = random.uniform(0.7, 1.4), spread = random.uniform(0.8, 1.25);
    const Vec3 shift_m = 0.05 * random.normal3(), turn = 0.06 * random.normal3();
    if (!on.has(Effect::PoorExposure)) continue;
    lamp.spot_intensity *= strength;
    lamp.flood_intensity *= strength;
    lamp.spot_half_angle_rad *= spread;
    lamp.position_B += shift_m;
    lamp.direction_B = (lamp.direction_B + turn).normalized();
  }
}

// The lamps of a vehicle are beside its cameras, look where they look, and are switched.
void equipWithLamps(const Dive& dive, RenderSettings& settings) {
  const double tilt_rad = dive.scenario.rig.camera_tilt_rad;
  settings.daylight.irradiance *= 0.3;  // it is deep
  for (size_t i = 0; i < settings.lamps.size(); ++i) {
    Lamp& lamp = settings.lamps[i];
    const double left = i % 2 == 0 ? 1.0 : -1.0;
    lamp.position_B = Vec3(0.22, 0.24 * left, 0.02);
    lamp.direction_B = Vec3(std::cos(tilt_rad), 0.05 * left, -std::sin(tilt_rad)).normalized();
    if (i < kLamps) {
      lamp.strength = [loads = dive.loads, i](double t) { return loads(t).lamps_A[i] / kLampCurrent_A; };
    }
  }
}

}  // namespace

std::shared_ptr<const RenderWorld> buildWorld(const Dive& dive) {
  const Scenario& s = dive.scenario;
  if (s.vehicle) {
    if (s.world == WorldKind::None) return nullptr;
    return std::make_shared<const RenderWorld>(vehicleWorld(dive), s.seed);
  }
  if (dive.wreck) {
    WreckOptions options;
    options.seed = s.seed;
    options.center_W = dive.wreck->center_W.cast<float>();
    options.heading_rad = static_cast<float>(dive.wreck->azimuth_rad);
    return buildWreckWorld(options);
  }
  if (dive.board) return buildBoardWorld(dive.board->board, dive.board->world_from_board, s.seed);
  if (!dive.passage) return nullptr;
  CaveOptions options;
  options.style = s.decorated ? CaveStyle::yucatanDecorated() : CaveStyle::floridaSpring();
  options.seed = s.cave_seed.value_or(s.seed);
  if (s.effects.has(Effect::BareWalls)) options.style.bare_share += 0.25f;
  if (dive.cave) return buildCaveWorld(dive.cave->layout, options, dive.cave->tags, dive.cave->origin_W);
  return buildCaveWorld(*dive.passage, options);
}

RenderSettings renderSettings(const Dive& dive) {
  const EffectSet& on = dive.scenario.effects;
  const RenderSettings field = RenderSettings::field();
  const bool in_open_water = dive.wreck || dive.sea_floor;
  RenderSettings settings = in_open_water            ? RenderSettings::openWater()
                            : dive.scenario.in_water ? RenderSettings::clean()
                                                     : RenderSettings::room();
  settings.seed = dive.scenario.seed;
  if (on.has(Effect::MilkyWater)) {
    settings.water = field.water;
    settings.snow = field.snow;
  }
  if (on.has(Effect::PoorExposure)) {
    settings.sensor = field.sensor;
    settings.lamps = field.lamps;
  }
  if (on.has(Effect::SecondDiver)) settings.second_diver = field.second_diver;
  if (on.has(Effect::SiltOuts)) settings.water.silt = drawSiltOuts(dive.scenario.duration_s, settings.seed);
  if (on.has(Effect::Daylight) && dive.passage) settings.daylight = entranceLight(*dive.passage);
  settings.sensor.readout_s = dive.errors.readout_s;
  settings.dispersion = on.has(Effect::Dispersion);
  settings.setCurrent(dive.current);
  settings.fish = dive.fish;
  settings.buddy = dive.buddy;
  settings.halocline = dive.halocline;
  if (dive.cave) drawSeason(on, dive.scenario.seed, settings);
  if (dive.scenario.vehicle) equipWithLamps(dive, settings);
  if (!on.has(Effect::MarineSnow)) settings.snow.flakes_per_m3 = 0.0;
  settings.sensor.noise = on.has(Effect::ImageNoise);
  settings.motion_blur = on.has(Effect::MotionBlur);
  settings.lens.port = dive.errors.port;
  settings.mountLamps(dive.errors.truth.diver_from_body);
  return settings;
}

std::vector<SiltEpisode> drawSiltOuts(double duration_s, uint64_t seed) {
  Random random(seed, "silt");
  std::vector<SiltEpisode> episodes;
  for (double t = random.uniform(15.0, 60.0); t < duration_s; t += random.uniform(40.0, 130.0)) {
    const double length_s = random.uniform(3.0, 8.0);
    episodes.push_back({t, length_s, random.uniform(1.0, 3.5)});
    t += length_s;
  }
  return episodes;
}

}  // namespace lodeline
