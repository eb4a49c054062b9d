#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"
#include "simulation/dive/effects.h"
#include "simulation/sensors/standard_rig.h"

namespace lodeline {

enum class WorldKind { Cave, Wreck, None };
enum class MotionKind { Dive, AroundWreck, FigureEight, AtRest };

/// All settings that determine a recording, down to its bytes.
struct Scenario {
  std::string name;
  std::string description;
  WorldKind world = WorldKind::Cave;
  MotionKind motion = MotionKind::Dive;
  bool decorated = false;  ///< a formerly dry cave with stalactites

  uint64_t seed = 1;
  /// Seed of the sensor noise (white noise and drifting biases of the IMU, noise of magnetometer and pressure
  /// sensor). Place, motion, images and the rig's own errors keep those of `seed`.
  std::optional<uint64_t> noise_seed;
  double duration_s = 0.0;
  double path_length_m = 0.0;
  bool starts_at_rest = true;
  bool images = true;

  GeodeticPosition site;
  std::string date = "2026-11-21";
  std::optional<Vec3> field_ENU;  ///< T, instead of the World Magnetic Model's
  double start_depth_m = 8.0;

  std::string imu_grade = "gx5-25";
  StandardRigOptions rig;
  EffectSet effects = EffectSet::clean();
};

/// User's changes to a scenario; values not given stay.
struct ScenarioChanges {
  std::optional<double> seconds, metres;
  std::optional<uint64_t> seed;
  std::optional<int> width_px, height_px, cameras;
  std::optional<double> camera_rate_hz, imu_rate_hz, magnetometer_rate_hz;
  std::optional<std::string> imu_grade;
  std::string realism = "clean";
  std::vector<std::string> effects;  ///< "name=on|off", applied after `realism`
  bool starts_moving = false;
  bool no_images = false;
  bool sonar_ahead = false;  ///< StandardRigOptions::sonar_scans_ahead
};

const std::vector<Scenario>& scenarios();

/// A scenario by name with changes. If only one of length and duration is given, the other changes in
/// proportion. Throws UsageError for an unknown name and for values without a possible recording.
Scenario makeScenario(std::string_view name, const ScenarioChanges& changes);

/// Seed of the sensor noise.
inline uint64_t noiseSeed(const Scenario& scenario) { return scenario.noise_seed.value_or(scenario.seed); }

/// The Earth's field at the scenario's site, T.
Vec3 scenarioField(const Scenario& scenario);

/// All settings as YAML. It identifies the scenario of an interrupted recording.
std::string describe(const Scenario& scenario);

}  // namespace lodeline
