#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/rig.h"
#include "lodeline/types.h"

namespace lodeline {

/// Deviations of a simulated recording from the ideal; each can be switched separately.
enum class Effect {
  // Effects of any recording, on in `clean` and `field`.
  ImuNoise,
  ImuBias,
  MagnetometerNoise,
  MagnetometerIron,
  PressureNoise,
  SonarNoise,
  ImageNoise,
  MotionBlur,
  MarineSnow,
  Daylight,
  // Effects of a diver's recording, on in `field`.
  CameraIntrinsics,
  CameraImuExtrinsics,
  StereoExtrinsics,
  MagnetometerExtrinsics,
  FlatPort,
  PortInFiles,
  CameraDelay,
  StampJitter,
  DroppedFrames,
  ImuScale,
  ImuWarmUp,
  MilkyWater,
  SiltOuts,
  SecondDiver,
  BareWalls,
  PoorExposure,
  HardIronCreep,
  MagneticDisturbances,
  LampCurrent,
  MagnetometerLag,
  DepthErrors,
  // Effects that are on only by request, and in `physical`.
  RollingShutter,
  ClockDrift,
  PortTilt,
  DomePort,
  Dispersion,
  GSensitivity,
  Current,
  Fish,
  Buddy,
  Halocline,
  ShutterInFiles,
  // Effects of the sensors of a vehicle, and of a wreck of steel.
  DvlNoise,
  DvlDropouts,
  DvlSentinels,
  DvlScale,
  DvlMisalignment,
  ThrusterCurrents,
  Vibration,
  Steel,
};
constexpr int kEffectCount = static_cast<int>(Effect::Steel) + 1;

struct EffectDescription {
  Effect effect;
  std::string_view name;  ///< as on the command line
  bool in_clean, in_field, in_physical;
  std::string_view what;
};
const std::array<EffectDescription, kEffectCount>& effectDescriptions();

class EffectSet {
 public:
  static EffectSet clean();
  static EffectSet field();
  /// `field` and all effects of optics, sensors and water that the estimator does not model. It has the flat
  /// port: a rig has one kind of port.
  static EffectSet physical();
  static EffectSet none() { return {}; }
  /// Effects of `clean`, `field` or `physical`; throws UsageError for any other word.
  static EffectSet named(std::string_view realism);

  bool has(Effect effect) const { return on_[static_cast<size_t>(effect)]; }
  /// Whether the cameras are behind a port: flat or dome, or one that another effect needs.
  bool hasPort() const;
  void set(Effect effect, bool on) { on_[static_cast<size_t>(effect)] = on; }
  /// Parses "name=on" or "name=off". Throws UsageError naming the existing effects.
  void set(const std::string& assignment);

 private:
  std::bitset<kEffectCount> on_;
};

/// A rig with its mounting in the frame D of the diver or the vehicle (x forward, y left, z up).
struct MountedRig {
  Rig rig;
  Rigid3 diver_from_body;
};

struct StandardRigOptions {
  int cameras = 2;
  int width_px = 640;
  int height_px = 480;
  double camera_rate_hz = 15.0;
  double imu_rate_hz = 200.0;
  double magnetometer_rate_hz = 50.0;
  double pressure_rate_hz = 2.0;
  double sonar_rate_hz = 20.0;
  /// Whether the sonar scans a horizontal sector of the view, and not all around across the view.
  bool sonar_scans_ahead = false;
  /// Name of a camera model (cameras/camera_model.h). Empty: the radial-tangential lenses of the rig itself.
  std::string camera_model;
  // Of a vehicle alone.
  double dvl_rate_hz = 5.0;
  double altimeter_rate_hz = 10.0;
  double current_rate_hz = 10.0;
  double camera_tilt_rad = 0.0;  ///< of all cameras, downwards from ahead
};

/// The hand-held rig of the simulator. Its cameras are side by side with a baseline of 14 cm, look ahead, are
/// 70 degrees wide (as behind glass in water) and have barrel distortion. The IMU is between them, upside
/// down and rotated; the magnetometer is inside the IMU. A pressure port is behind, and a sonar head below
/// scans across the view, or a horizontal sector of it. As in any rig, the extrinsics differ a little from
/// the drawing. The IMU noise has its default. A `camera_model` gives both cameras that model's typical lens,
/// with focal lengths 0.3 % apart.
MountedRig standardRig(const StandardRigOptions& options);

/// The rig of a vehicle: IMU and magnetometer near its middle, cameras at its front. Below it are a DVL
/// of four beams at 22.5 degrees, an altimeter and a scanning sonar.
MountedRig vehicleRig(const StandardRigOptions& options);

enum class WorldKind { Cave, Wreck, SeaFloor, Board, None };
/// Plan of a cave: one passage, a circuit, a passage with a branch, or one chamber.
enum class CaveShape { Passage, Loop, Junction, Room };
enum class MotionKind {
  Dive,
  AroundWreck,
  BeforeBoard,
  FigureEight,
  AtRest,
  Transects,     ///< of a vehicle above the sea floor
  ThroughWreck,  ///< laps of a vehicle around and through a hull
  CurrentRamps,  ///< a vehicle at rest: the current of each channel rises and falls
};

/// All settings that determine a recording, down to its bytes.
struct Scenario {
  std::string name;
  std::string description;
  WorldKind world = WorldKind::Cave;
  MotionKind motion = MotionKind::Dive;
  bool in_water = true;       ///< false: in a room, without lamps and ports
  bool decorated = false;     ///< a formerly dry cave with stalactites
  bool vehicle = false;       ///< with thrusters, DVL, altimeter and measured currents, in place of a diver
  bool cables_moved = false;  ///< the vehicle on another day: its currents disturb the magnetometer otherwise

  /// Seed of the motion, the rig with its errors, the lamps, the water and the disturbances, and of the place
  /// where `cave_seed` is not given.
  uint64_t seed = 1;
  /// Seed of the cave: shape, walls, texture and tags. A scenario with it has a frame of the cave
  /// (`truth/cave.yaml`), in which all its dives are in the same rock.
  std::optional<uint64_t> cave_seed;
  CaveShape shape = CaveShape::Passage;
  int laps = 2;                         ///< of a circuit, a chamber, or a wreck
  int entrance = 1;                     ///< 2: a dive from the far end of the passage
  std::optional<double> cave_length_m;  ///< of the passage; half of the path where not given
  int tags = 0;                         ///< AprilTags on the line
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
  std::optional<double> readout_s;  ///< of the rolling shutter; drawn where not given
  StandardRigOptions rig;
  EffectSet effects = EffectSet::clean();
};

/// User's changes to a scenario; values not given stay.
struct ScenarioChanges {
  std::optional<double> seconds, metres;
  std::optional<uint64_t> seed;                  ///< of cave and dive
  std::optional<uint64_t> cave_seed, dive_seed;  ///< in place of `seed`
  std::optional<double> cave_metres;             ///< Scenario::cave_length_m
  std::optional<int> laps, entrance, tags;
  std::optional<int> width_px, height_px, cameras;
  std::optional<double> camera_rate_hz, imu_rate_hz, magnetometer_rate_hz;
  std::optional<std::string> imu_grade;
  std::optional<std::string> camera_model;
  std::optional<double> readout_ms;  ///< of a rolling shutter, which it switches on
  std::string realism = "clean";
  std::vector<std::string> effects;  ///< "name=on|off", applied after `realism`
  bool starts_moving = false;
  bool no_images = false;
  bool sonar_ahead = false;  ///< StandardRigOptions::sonar_scans_ahead
  bool cables_moved = false;
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

struct ImageProgress {
  size_t done = 0;      ///< number of images in the folder
  size_t rendered = 0;  ///< number of them rendered by this run
  size_t total = 0;
};

struct ImageRecordingOptions {
  int threads = 0;                                     ///< 0: number of processors
  std::function<bool()> stop;                          ///< called after each image
  std::function<void(const ImageProgress&)> progress;  ///< called after each image, one call at a time
};

struct RecordingSummary {
  double path_length_m = 0.0;
  double duration_s = 0.0;
  ImageProgress images;
  bool resumed = false;
  bool complete = true;
};

/// Simulates a scenario into a folder: mav0 in the EuRoC layout, and truth/. A folder with an unfinished
/// recording of the same scenario is completed. Throws InputError where the folder has any other content.
/// `stage` receives a description of each step.
RecordingSummary recordScenario(const Scenario& scenario, const std::filesystem::path& folder,
                                const ImageRecordingOptions& options,
                                const std::function<void(const char*)>& stage = {});

/// Writes the recording of `scenario` in `original` to `folder` with other sensor noise
/// (Scenario::noise_seed). It writes the readings of IMU, magnetometer and pressure sensor and the true
/// biases; images and sonar are links to the original. Throws InputError where `original` has another
/// recording, or `folder` is not empty.
void recordOtherNoise(const Scenario& scenario, const std::filesystem::path& original,
                      const std::filesystem::path& folder);

/// Whether the folder has a recording of this scenario, complete or not.
bool holdsRecording(const Scenario& scenario, const std::filesystem::path& folder);

}  // namespace lodeline
