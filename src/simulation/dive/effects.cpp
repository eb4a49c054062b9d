#include "lodeline/simulation.h"

#include <fmt/core.h>

#include "lodeline/diagnostics.h"

namespace lodeline {

const std::array<EffectDescription, kEffectCount>& effectDescriptions() {
  static const std::array<EffectDescription, kEffectCount> table = {{
      {Effect::ImuNoise, "imu_noise", true, true, true, "white noise, bias instability and random walk"},
      {Effect::ImuBias, "imu_bias", true, true, true, "turn-on biases"},
      {Effect::MagnetometerNoise, "magnetometer_noise", true, true, true, "white noise and resolution"},
      {Effect::MagnetometerIron, "magnetometer_iron", true, true, true,
       "soft iron, hard iron of 6-20 uT, 0.5-1.5 degrees of misalignment to the IMU"},
      {Effect::PressureNoise, "pressure_noise", true, true, true, "noise of 1 cm, resolution of 1 cm"},
      {Effect::SonarNoise, "sonar_noise", true, true, true,
       "noise of 3 cm, 10 % lost and 2 % spurious echoes"},
      {Effect::ImageNoise, "image_noise", true, true, true, "photon and read noise"},
      {Effect::MotionBlur, "motion_blur", true, true, true, "motion over the exposure"},
      {Effect::MarineSnow, "marine_snow", true, true, true, "flakes adrift in the water"},
      {Effect::Daylight, "daylight", true, true, true, "light falling in at the entrance"},
      {Effect::CameraIntrinsics, "camera_intrinsics", false, true, true,
       "files say 0.1-0.5 % wrong focal lengths, 1-3 px wrong principal points"},
      {Effect::CameraImuExtrinsics, "camera_imu_extrinsics", false, true, true,
       "files say 0.1-0.5 degrees and 5-10 mm wrong camera-IMU poses"},
      {Effect::StereoExtrinsics, "stereo_extrinsics", false, true, true,
       "files say 0.02-0.1 degrees wrong stereo rotation"},
      {Effect::MagnetometerExtrinsics, "magnetometer_extrinsics", false, true, true,
       "files leave the magnetometer's misalignment to the IMU out"},
      {Effect::FlatPort, "flat_port", false, true, true,
       "a flat window refracts the rays; files hold the best radial-tangential fit; in air: its lenses "
       "alone"},
      {Effect::PortInFiles, "port_in_files", false, false, false,
       "files hold the window of flat_port and the lens in air instead"},
      {Effect::CameraDelay, "camera_delay", false, true, true,
       "image stamps 3-8 ms late, unknown to the files"},
      {Effect::StampJitter, "stamp_jitter", false, true, true, "image stamps scatter by 0.5 ms"},
      {Effect::DroppedFrames, "dropped_frames", false, true, true, "1-3 % of images missing"},
      {Effect::ImuScale, "imu_scale", false, true, true, "scale errors and misaligned axes"},
      {Effect::ImuWarmUp, "imu_warm_up", false, true, true, "biases drift while the electronics warm up"},
      {Effect::MilkyWater, "milky_water", false, true, true, "water of 2-3 m sight"},
      {Effect::SiltOuts, "silt_outs", false, true, true, "3-8 s of stirred-up silt"},
      {Effect::SecondDiver, "second_diver", false, true, true, "a companion's lamp sweeps the walls"},
      {Effect::BareWalls, "bare_walls", false, true, true, "smooth sediment and flowstone without texture"},
      {Effect::PoorExposure, "poor_exposure", false, true, true,
       "longer exposures, flickering gain, unequal lamps"},
      {Effect::HardIronCreep, "hard_iron_creep", false, true, true,
       "hard iron drifts by 0.1-0.3 uT over the dive"},
      {Effect::MagneticDisturbances, "magnetic_disturbances", false, true, true,
       "iron nearby turns the heading by 2-10 degrees for 10-30 s"},
      {Effect::LampCurrent, "lamp_current", false, true, true, "0.1-0.4 uT with the lamp's current"},
      {Effect::MagnetometerLag, "magnetometer_lag", false, true, true,
       "readings 14-16 ms old, 29 % repeated"},
      {Effect::DepthErrors, "depth_errors", false, true, true,
       "offset of 5-30 cm, wrong density, lag of 0.3-1 s"},
      {Effect::RollingShutter, "rolling_shutter", false, false, true,
       "rows exposed one after another over 10-30 ms"},
      {Effect::ClockDrift, "clock_drift", false, false, true, "camera clock 5-30 ppm off the IMU's"},
      {Effect::PortTilt, "port_tilt", false, false, true, "the flat port tilted by 0.4-1.0 degrees"},
      {Effect::DomePort, "dome_port", false, false, false,
       "a dome port 1-3 mm off the lens, in place of the flat port"},
      {Effect::Dispersion, "dispersion", false, false, true,
       "index of water and port by wavelength: points smeared radially"},
      {Effect::GSensitivity, "g_sensitivity", false, false, true,
       "gyroscope reads 0.01-0.1 deg/s per g, by grade"},
      {Effect::Current, "current", false, false, true, "a current of 8-25 cm/s carries snow, haze and fish"},
      {Effect::Fish, "fish", false, false, true, "schools of fish swim through the view"},
      {Effect::Buddy, "buddy", false, false, true, "a diver with a torch swims in view, with shadows"},
      {Effect::Halocline, "halocline", false, false, true,
       "a quarter of the dive in salt water: density, index, blur"},
      {Effect::ShutterInFiles, "shutter_in_files", false, false, true,
       "calibration files say that the shutter is rolling"},
      {Effect::DvlNoise, "dvl_noise", true, true, true, "vehicle: 6 mm/s along each beam, 2 cm of range"},
      {Effect::DvlDropouts, "dvl_dropouts", false, true, true,
       "vehicle: 10 % of the DVL's beams without lock"},
      {Effect::DvlSentinels, "dvl_sentinels", false, false, true,
       "vehicle: 5 % of the beams say 0.0 m/s and -2.0 m as if valid"},
      {Effect::DvlScale, "dvl_scale", false, true, true, "vehicle: speed of sound off by 0.7-1.3 %"},
      {Effect::DvlMisalignment, "dvl_misalignment", false, true, true,
       "vehicle: files say a DVL turned by 2-3.5 degrees"},
      {Effect::ThrusterCurrents, "thruster_currents", false, true, true,
       "vehicle: thrusters disturb the magnetometer by 6-12 uT each at 20 A"},
      {Effect::Vibration, "vibration", false, true, true, "vehicle: thrusters shake the IMU at 20-160 Hz"},
      {Effect::Steel, "steel", true, true, true, "wreck: the hull bends the field"},
  }};
  return table;
}

EffectSet EffectSet::clean() {
  EffectSet set;
  for (const EffectDescription& d : effectDescriptions()) set.set(d.effect, d.in_clean);
  return set;
}

EffectSet EffectSet::field() {
  EffectSet set;
  for (const EffectDescription& d : effectDescriptions()) set.set(d.effect, d.in_field);
  return set;
}

EffectSet EffectSet::physical() {
  EffectSet set;
  for (const EffectDescription& d : effectDescriptions()) set.set(d.effect, d.in_physical);
  return set;
}

bool EffectSet::hasPort() const {
  return has(Effect::FlatPort) || has(Effect::PortTilt) || has(Effect::DomePort) || has(Effect::Dispersion) ||
         has(Effect::Halocline);
}

EffectSet EffectSet::named(std::string_view realism) {
  if (realism == "clean") return clean();
  if (realism == "field") return field();
  if (realism == "physical") return physical();
  throw UsageError(fmt::format("there is no realism '{}'; there are clean, field and physical", realism));
}

void EffectSet::set(const std::string& assignment) {
  const size_t equals = assignment.find('=');
  const std::string name = assignment.substr(0, equals);
  const std::string value = equals == std::string::npos ? "" : assignment.substr(equals + 1);
  if (value != "on" && value != "off") {
    throw UsageError(fmt::format("effect '{}': write NAME=on or NAME=off", assignment));
  }
  std::string names;
  for (const EffectDescription& d : effectDescriptions()) {
    if (d.name == name) return set(d.effect, value == "on");
    names += fmt::format("{}{}", names.empty() ? "" : ", ", d.name);
  }
  throw UsageError(fmt::format("there is no effect '{}'; there are {}", name, names));
}

}  // namespace lodeline
