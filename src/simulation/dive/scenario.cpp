#include "lodeline/simulation.h"

#include <fmt/core.h>

#include <cmath>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"
#include "lodeline/util/angles.h"
#include "simulation/dive/vehicle_dive.h"
#include "simulation/motion/vehicle_motion.h"
#include "simulation/sensors/imu_model.h"
#include "simulation/vehicle/still_ramps.h"

namespace lodeline {
namespace {

const GeodeticPosition kDevilsEye{29.83, -82.60, 10.0};
const GeodeticPosition kDosOjos{20.32, -87.39, 5.0};

Scenario scenario(const char* name, const char* description, double duration_s, double path_length_m,
                  const GeodeticPosition& site) {
  Scenario s;
  s.name = name;
  s.description = description;
  s.duration_s = duration_s;
  s.path_length_m = path_length_m;
  s.site = site;
  return s;
}

// A scenario whose cave has a frame.
Scenario caveScenario(const char* name, const char* description, double duration_s, double path_length_m,
                      CaveShape shape) {
  Scenario s = scenario(name, description, duration_s, path_length_m, kDevilsEye);
  s.shape = shape;
  s.cave_seed = s.seed;
  return s;
}

Scenario vehicleScenario(const char* name, const char* description, double duration_s, double path_length_m,
                         WorldKind world, MotionKind motion) {
  Scenario s = scenario(name, description, duration_s, path_length_m, kDevilsEye);
  s.vehicle = true;
  s.world = world;
  s.motion = motion;
  s.imu_grade = "consumer";
  s.start_depth_m = 20.0;
  s.rig.cameras = 1;
  return s;
}

void addVehicleScenarios(std::vector<Scenario>& all) {
  Scenario auv = vehicleScenario("auv", "a vehicle on transects 2 m above the sea floor; one camera", 780.0,
                                 300.0, WorldKind::SeaFloor, MotionKind::Transects);
  auv.rig.camera_tilt_rad = 60.0 * kDegree;
  all.push_back(auv);

  Scenario wreck =
      vehicleScenario("wreck", "a vehicle, three laps around and through a steel hull; stereo", 1180.0,
                      wreckLapLength_m(steelWreck(), 3), WorldKind::Wreck, MotionKind::ThroughWreck);
  wreck.rig.cameras = 2;
  wreck.rig.camera_tilt_rad = 5.0 * kDegree;
  wreck.laps = 3;
  all.push_back(wreck);

  Scenario ramps = vehicleScenario("current_ramps", "a vehicle at rest; each current rises and falls",
                                   RampTimes().duration_s(), 0.0, WorldKind::None, MotionKind::CurrentRamps);
  ramps.images = false;
  all.push_back(ramps);
}

std::vector<Scenario> makeScenarios() {
  std::vector<Scenario> all;
  all.push_back(scenario("cave1_short", "Devil's Eye, 110 m in and back; stereo", 900.0, 220.0, kDevilsEye));

  Scenario long_dive =
      scenario("cave1_long", "Devil's Eye, 253 m in and back; one camera", 1980.0, 506.0, kDevilsEye);
  long_dive.imu_grade = "gv7";
  long_dive.rig.cameras = 1;
  all.push_back(long_dive);

  Scenario dos_ojos =
      scenario("dos_ojos", "Dos Ojos, decorated, 340 m in and back; stereo", 3060.0, 680.0, kDosOjos);
  dos_ojos.decorated = true;
  dos_ojos.start_depth_m = 4.0;
  all.push_back(dos_ojos);

  Scenario demo = scenario("demo", "a short excerpt of a decorated cave; stereo", 45.0, 9.0, kDosOjos);
  demo.decorated = true;
  demo.start_depth_m = 6.0;
  all.push_back(demo);

  all.push_back(
      caveScenario("loop_cave", "a circuit of 75 m swum twice; stereo", 690.0, 150.0, CaveShape::Loop));
  all.push_back(caveScenario("junction", "a passage and its branch, each in and back; stereo", 700.0, 160.0,
                             CaveShape::Junction));
  all.push_back(caveScenario("room", "one chamber swum through twice on different ways; stereo", 350.0, 85.0,
                             CaveShape::Room));
  Scenario two_entrances =
      caveScenario("two_entrances", "a cave of 80 m, 60 m in and back from either end; stereo", 500.0, 120.0,
                   CaveShape::Passage);
  two_entrances.cave_length_m = 80.0;
  all.push_back(two_entrances);

  Scenario figure_eight =
      scenario("figure_eight", "the rig turned about all axes, for calibrating the magnetometer", 90.0, 0.0,
               kDevilsEye);
  figure_eight.world = WorldKind::None;
  figure_eight.motion = MotionKind::FigureEight;
  figure_eight.images = false;
  all.push_back(figure_eight);

  Scenario board = scenario("board", "a board of AprilTags in a room, for calibrating the cameras; stereo",
                            40.0, 0.0, kDevilsEye);
  board.world = WorldKind::Board;
  board.motion = MotionKind::BeforeBoard;
  board.in_water = false;
  all.push_back(board);

  board.name = "board_in_water";
  board.description = "the same board under water";
  board.in_water = true;
  board.start_depth_m = 2.0;
  all.push_back(board);

  Scenario bench = scenario("bench", "at rest for hours, for Allan analysis", 10800.0, 0.0, kDevilsEye);
  bench.world = WorldKind::None;
  bench.motion = MotionKind::AtRest;
  bench.images = false;
  all.push_back(bench);

  Scenario open_water = scenario("open_water", "free swimming about a wreck; stereo", 400.0, 100.0, kDosOjos);
  open_water.world = WorldKind::Wreck;
  open_water.motion = MotionKind::AroundWreck;
  open_water.start_depth_m = 14.0;
  all.push_back(open_water);
  addVehicleScenarios(all);
  return all;
}

double positive(double value, const char* what) {
  if (!(std::isfinite(value) && value > 0.0))
    throw UsageError(fmt::format("{} must be positive, got {:g}", what, value));
  return value;
}

void changeExtent(const ScenarioChanges& c, Scenario& s) {
  if (c.metres && s.path_length_m == 0.0) {
    throw UsageError(fmt::format("{} goes nowhere: it can be scaled with --seconds, not --metres", s.name));
  }
  const double standard_speed = s.path_length_m / s.duration_s;
  if (c.seconds) s.duration_s = positive(*c.seconds, "--seconds");
  if (c.metres) s.path_length_m = positive(*c.metres, "--metres");
  if (c.seconds && !c.metres) s.path_length_m = standard_speed * s.duration_s;
  if (c.metres && !c.seconds) s.duration_s = s.path_length_m / standard_speed;
}

// Cave, dive and what is common to dives of one cave.
void changePlace(const ScenarioChanges& c, Scenario& s) {
  const bool in_cave = s.world == WorldKind::Cave;
  const auto only = [&](bool given, bool possible, const char* option, const char* where) {
    if (given && !possible) throw UsageError(fmt::format("{}: {} has no {}", option, s.name, where));
  };
  only(c.cave_seed.has_value(), in_cave, "--cave-seed", "cave");
  only(c.tags.has_value(), in_cave, "--tags", "cave");
  const bool around_wreck = s.motion == MotionKind::ThroughWreck;
  only(c.laps.has_value(), s.shape == CaveShape::Loop || s.shape == CaveShape::Room || around_wreck, "--laps",
       "circuit");
  const bool has_far_end = in_cave && s.shape == CaveShape::Passage;
  only(c.entrance.has_value(), has_far_end, "--entrance", "passage with two ends");
  only(c.cave_metres.has_value(), has_far_end, "--cave-metres", "passage with two ends");
  s.seed = c.dive_seed.value_or(c.seed.value_or(1));
  const bool framed = s.cave_seed || c.cave_seed || c.tags || c.entrance || c.cave_metres || c.dive_seed;
  if (in_cave && framed) s.cave_seed = c.cave_seed.value_or(c.seed.value_or(1));
  if (c.laps) {
    // A change of laps alone keeps the circuit.
    if (!c.metres && (s.shape == CaveShape::Loop || around_wreck) && !c.seconds) {
      const double ratio = around_wreck ? wreckLapLength_m(steelWreck(), *c.laps) / s.path_length_m
                                        : static_cast<double>(*c.laps) / s.laps;
      s.path_length_m *= ratio;
      s.duration_s *= ratio;
    }
    s.laps = *c.laps;
  }
  if (c.entrance) s.entrance = *c.entrance;
  if (c.cave_metres) s.cave_length_m = positive(*c.cave_metres, "--cave-metres");
  if (c.tags) s.tags = *c.tags;
  if (s.tags < 0 || s.tags > 100) throw UsageError(fmt::format("--tags must be 0 to 100, got {}", s.tags));
}

constexpr Effect kVehicleEffects[] = {Effect::DvlNoise, Effect::DvlDropouts,     Effect::DvlSentinels,
                                      Effect::DvlScale, Effect::DvlMisalignment, Effect::ThrusterCurrents,
                                      Effect::Vibration};

// Effects of things that the scenario does not have.
void refuseForeignEffects(const Scenario& s) {
  const auto refuse = [&](Effect effect, const char* where) {
    if (!s.effects.has(effect)) return;
    throw UsageError(fmt::format("--effect {}: {} has no {}",
                                 effectDescriptions()[static_cast<size_t>(effect)].name, s.name, where));
  };
  if (!s.vehicle) {
    for (const Effect effect : kVehicleEffects) refuse(effect, "vehicle");
  }
  if (s.motion != MotionKind::ThroughWreck) refuse(Effect::Steel, "wreck of steel");
}

void changeCameraModel(const std::string& name, Scenario& s) {
  const CameraModel* model = findCameraModel(name);
  if (model == nullptr) {
    throw UsageError(
        fmt::format("--camera-model: there is no model '{}'; there are {}", name, cameraModelNames()));
  }
  if (s.effects.hasPort()) {
    throw UsageError(
        "--camera-model: a port makes the lenses itself, by refraction; switch it off with --effect "
        "flat_port=off (and port_tilt, dome_port, dispersion and halocline)");
  }
  s.rig.camera_model = model->name;
}

}  // namespace

const std::vector<Scenario>& scenarios() {
  static const std::vector<Scenario> all = makeScenarios();
  return all;
}

Scenario makeScenario(std::string_view name, const ScenarioChanges& c) {
  const Scenario* found = nullptr;
  std::string names;
  for (const Scenario& s : scenarios()) {
    if (s.name == name) found = &s;
    names += (names.empty() ? "" : ", ") + s.name;
  }
  if (found == nullptr) throw UsageError(fmt::format("there is no scenario '{}'; there are {}", name, names));
  Scenario s = *found;
  changeExtent(c, s);
  changePlace(c, s);
  if (c.imu_grade) s.imu_grade = imuGrade(*c.imu_grade).name;
  // Images keep the aspect ratio of the rig unless both sizes are given.
  if (c.width_px) {
    s.rig.width_px = static_cast<int>(positive(*c.width_px, "--width"));
    s.rig.height_px = *c.width_px * 3 / 4;
  }
  if (c.height_px) s.rig.height_px = static_cast<int>(positive(*c.height_px, "--height"));
  if (s.rig.width_px < 64 || s.rig.height_px < 48 || s.rig.width_px > 4096 || s.rig.height_px > 4096) {
    throw UsageError(fmt::format("images of {} x {} px: both sides must lie between 64 x 48 and 4096 x 4096",
                                 s.rig.width_px, s.rig.height_px));
  }
  if (c.cameras) s.rig.cameras = *c.cameras;
  if (s.rig.cameras < 1 || s.rig.cameras > 2) throw UsageError("--cameras: the rig holds one or two");
  if (c.camera_rate_hz) s.rig.camera_rate_hz = positive(*c.camera_rate_hz, "--camera-rate-hz");
  if (c.imu_rate_hz) s.rig.imu_rate_hz = positive(*c.imu_rate_hz, "--imu-rate-hz");
  if (c.magnetometer_rate_hz)
    s.rig.magnetometer_rate_hz = positive(*c.magnetometer_rate_hz, "--magnetometer-rate-hz");
  s.effects = EffectSet::named(c.realism);
  if (!s.in_water) {
    for (const Effect effect : {Effect::FlatPort, Effect::MarineSnow, Effect::MilkyWater, Effect::SiltOuts,
                                Effect::SecondDiver, Effect::PoorExposure}) {
      s.effects.set(effect, false);
    }
  }
  if (!s.vehicle) {
    for (const Effect effect : kVehicleEffects) s.effects.set(effect, false);
  }
  if (s.motion != MotionKind::ThroughWreck) s.effects.set(Effect::Steel, false);
  if (s.motion == MotionKind::CurrentRamps) s.effects.set(Effect::ThrusterCurrents, true);
  for (const std::string& assignment : c.effects) s.effects.set(assignment);
  refuseForeignEffects(s);
  if (c.camera_model) changeCameraModel(*c.camera_model, s);
  if (c.readout_ms) {
    s.readout_s = 1e-3 * positive(*c.readout_ms, "--readout-ms");
    s.effects.set(Effect::RollingShutter, true);
  }
  s.starts_at_rest = !c.starts_moving;
  if (c.no_images) s.images = false;
  s.rig.sonar_scans_ahead = c.sonar_ahead;
  if (c.cables_moved && !s.vehicle)
    throw UsageError(fmt::format("--cables-moved: {} has no vehicle", s.name));
  s.cables_moved = c.cables_moved;
  return s;
}

Vec3 scenarioField(const Scenario& s) {
  return s.field_ENU ? *s.field_ENU : worldMagneticField(s.site, decimalYear(s.date)).field_ENU;
}

std::string describe(const Scenario& s) {
  std::string text = fmt::format(
      "scenario: {}\nseed: {}\nduration_s: {}\npath_length_m: {}\nstarts_at_rest: {}\nimages: {}\n"
      "site: {{latitude_deg: {}, longitude_deg: {}, height_m: {}, date: {}}}\nstart_depth_m: {}\nimu_grade: "
      "{}\n",
      s.name, s.seed, s.duration_s, s.path_length_m, s.starts_at_rest, s.images, s.site.latitude_deg,
      s.site.longitude_deg, s.site.height_m, s.date, s.start_depth_m, s.imu_grade);
  text += fmt::format(
      "rig: {{cameras: {}, width_px: {}, height_px: {}, camera_rate_hz: {}, imu_rate_hz: {}, "
      "magnetometer_rate_hz: {}, pressure_rate_hz: {}, sonar_rate_hz: {}}}\neffects:\n",
      s.rig.cameras, s.rig.width_px, s.rig.height_px, s.rig.camera_rate_hz, s.rig.imu_rate_hz,
      s.rig.magnetometer_rate_hz, s.rig.pressure_rate_hz, s.rig.sonar_rate_hz);
  for (const EffectDescription& d : effectDescriptions()) {
    // Later effects appear only where they are on, so that earlier recordings keep their identity.
    const bool on = s.effects.has(d.effect);
    if (on || d.effect <= Effect::ClockDrift) text += fmt::format("  {}: {}\n", d.name, on ? "on" : "off");
  }
  if (!s.rig.camera_model.empty()) text += fmt::format("camera_model: {}\n", s.rig.camera_model);
  if (s.readout_s) text += fmt::format("readout_s: {}\n", *s.readout_s);
  if (s.rig.sonar_scans_ahead) text += "sonar_scans_ahead: true\n";
  if (s.cables_moved) text += "cables_moved: true\n";
  if (s.cave_seed) {
    text += fmt::format("cave_seed: {}\nlaps: {}\nentrance: {}\ntags: {}\n", *s.cave_seed, s.laps, s.entrance,
                        s.tags);
    if (s.cave_length_m) text += fmt::format("cave_length_m: {}\n", *s.cave_length_m);
  }
  if (s.noise_seed) text += fmt::format("noise_seed: {}\n", *s.noise_seed);
  return text;
}

}  // namespace lodeline
