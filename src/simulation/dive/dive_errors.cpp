#include "simulation/dive/dive_errors.h"

#include <numbers>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

Quat drawTurn(double least_rad, double most_rad, Random& random) {
  const double angle = random.uniform(least_rad, most_rad);
  return so3::exp(angle * random.direction());
}

// Errors of the given intrinsics. Their causes (target, water, window) affect both cameras of a calibration
// equally. It fits both together, so the stereo images still agree to a fraction of a pixel. The errors are
// therefore mostly common, with a small part for each camera.
void misstateIntrinsics(uint64_t seed, Rig& given) {
  Random common(seed, "calibration/intrinsics");
  const double focal_error = common.sign() * common.uniform(0.0012, 0.0048);
  const double size_px = common.uniform(1.2, 2.8);
  const double angle = common.uniform(0.0, 2.0 * std::numbers::pi);
  for (CameraCalibration& camera : given.cameras) {
    Random own(seed, "calibration/intrinsics/" + camera.name);
    camera.fx_px *= 1.0 + focal_error + own.uniform(-1.5e-4, 1.5e-4);
    camera.fy_px *= 1.0 + focal_error + own.uniform(-1.5e-4, 1.5e-4);
    const double scale = camera.width_px / 640.0;
    camera.cx_px += scale * (size_px * std::cos(angle) + own.uniform(-0.12, 0.12));
    camera.cy_px += scale * (size_px * std::sin(angle) + own.uniform(-0.12, 0.12));
  }
}

void misstateExtrinsics(const EffectSet& effects, uint64_t seed, Rig& given) {
  if (effects.has(Effect::CameraImuExtrinsics)) {
    Random random(seed, "calibration/camera-imu");
    const Quat turn = drawTurn(0.1 * kDegree, 0.5 * kDegree, random);
    const double distance_m = random.uniform(0.005, 0.010);
    const Vec3 shift = distance_m * random.direction();
    // Rotation about the first camera, so that the stereo geometry is unchanged.
    const Vec3 pivot = given.cameras.front().body_from_camera.translation;
    for (CameraCalibration& camera : given.cameras) {
      const Rigid3& pose = camera.body_from_camera;
      camera.body_from_camera =
          Rigid3(turn * pose.rotation, pivot + turn * (pose.translation - pivot) + shift);
    }
  }
  if (effects.has(Effect::StereoExtrinsics) && given.cameras.size() > 1) {
    Random random(seed, "calibration/stereo");
    Rigid3& pose = given.cameras[1].body_from_camera;
    pose.rotation = (pose.rotation * drawTurn(0.02 * kDegree, 0.1 * kDegree, random)).normalized();
  }
}

Port described(const PortWindow& window) {
  Port port;
  if (const auto* plate = std::get_if<FlatPort>(&window)) {
    port.normal_C = plate->normal_C;
    port.distance_m = plate->distance_m;
    port.thickness_m = plate->thickness_m;
  } else {
    const DomePort& dome = std::get<DomePort>(window);
    port.type = Port::Type::Dome;
    port.centre_C = dome.centre_C;
    port.radius_m = dome.radius_m;
    port.thickness_m = dome.thickness_m;
  }
  port.index_glass = glassIndex(window);
  port.index_water = waterIndex(window);
  return port;
}

PortWindow drawFlatPort(const EffectSet& effects, uint64_t seed) {
  Random random(seed, "port");
  FlatPort port;
  port.normal_C = (Vec3::UnitZ() + 0.6 * kDegree * random.normal3()).normalized();
  port.distance_m = random.uniform(0.010, 0.025);
  if (effects.has(Effect::PortTilt)) {
    Random tilt(seed, "port/tilt");
    const double angle = tilt.uniform(0.4, 1.0) * kDegree;
    const double towards = tilt.uniform(0.0, 2.0 * std::numbers::pi);
    port.normal_C =
        Vec3(std::sin(angle) * std::cos(towards), std::sin(angle) * std::sin(towards), std::cos(angle));
  }
  return port;
}

PortWindow drawDomePort(uint64_t seed) {
  Random random(seed, "port/dome");
  DomePort port;
  port.radius_m = random.uniform(0.040, 0.060);
  port.centre_C = random.uniform(0.001, 0.003) * random.direction();
  return port;
}

// The lenses of the housing without the port, as on a bench.
void takeOutOfHousing(const EffectSet& effects, uint64_t seed, DiveErrors& errors) {
  const PortWindow port = effects.has(Effect::DomePort) ? drawDomePort(seed) : drawFlatPort(effects, seed);
  for (CameraCalibration& camera : errors.truth.rig.cameras) camera = airCameraFor(camera, port);
  errors.in_water = errors.truth.rig;
}

void putBehindPort(const EffectSet& effects, uint64_t seed, DiveErrors& errors) {
  const bool in_files = effects.has(Effect::PortInFiles);
  const PortWindow port = effects.has(Effect::DomePort) ? drawDomePort(seed) : drawFlatPort(effects, seed);
  errors.port = port;
  errors.port_fit_rms_px = 0.0;
  for (size_t i = 0; i < errors.truth.rig.cameras.size(); ++i) {
    CameraCalibration& camera = errors.truth.rig.cameras[i];
    camera = airCameraFor(camera, port);
    const PortFit fit = fitRadialTangential(camera, port);
    errors.in_water.cameras[i] = fit.calibration;
    if (in_files) {
      errors.in_water.cameras[i] = camera;
      errors.in_water.cameras[i].port = described(port);
    }
    errors.port_fit_rms_px = std::max(errors.port_fit_rms_px, fit.rms_px);
  }
}

// The true rig knows its line delay. The files at most say that the shutter is rolling, as a data sheet does:
// a readout of 16.5 ms, give or take 10 ms.
void describeShutter(const EffectSet& effects, DiveErrors& errors) {
  if (errors.readout_s <= 0.0) return;
  for (CameraCalibration& camera : errors.in_water.cameras)
    camera.line_delay_s = errors.readout_s / camera.height_px;
  if (!effects.has(Effect::ShutterInFiles)) return;
  for (CameraCalibration& camera : errors.given.cameras) {
    camera.line_delay_s = 0.0165 / camera.height_px;
    camera.line_delay_sigma_s = 0.010 / camera.height_px;
  }
}

void drawClocks(const Scenario& s, DiveErrors& errors) {
  Random random(s.seed, "clock/camera");
  const double delay_s = random.uniform(0.003, 0.008);
  const double drift_ppm = random.sign() * random.uniform(5.0, 30.0);
  const double dropped = random.uniform(0.01, 0.03);
  if (s.effects.has(Effect::CameraDelay)) errors.camera_clock.delay_s = delay_s;
  if (s.effects.has(Effect::ClockDrift)) errors.camera_clock.drift_ppm = drift_ppm;
  if (s.effects.has(Effect::StampJitter)) errors.camera_clock.jitter_s = 0.0005;
  if (s.effects.has(Effect::RollingShutter)) {
    Random shutter(s.seed, "camera/readout");
    errors.readout_s = s.readout_s.value_or(shutter.uniform(0.010, 0.030));
  }
  if (s.effects.has(Effect::DroppedFrames)) errors.dropped_image_share = dropped;
}

void drawDepthAndSonar(const Scenario& s, DiveErrors& errors) {
  Random random(s.seed, "pressure/specimen");
  const double offset_m = random.sign() * random.uniform(0.05, 0.30);
  const double lag_s = random.uniform(0.3, 1.0);
  // A gauge with the density of salt water in a spring, or of fresh water in the halocline.
  const double density_ratio = random.chance(0.5) ? 998.0 / 1025.0 : 1010.0 / 1000.0;
  if (s.effects.has(Effect::PressureNoise)) {
    errors.pressure.noise_m = 0.01;
    errors.pressure.resolution_m = 0.01;
  }
  if (s.effects.has(Effect::DepthErrors)) {
    errors.pressure.offset_m = offset_m;
    errors.pressure.lag_s = lag_s;
    errors.pressure.density_ratio = density_ratio;
  }
  if (s.rig.sonar_scans_ahead) errors.sonar.sector_rad = 30.0 * kDegree;
  if (s.effects.has(Effect::SonarNoise)) {
    errors.sonar.noise_m = 0.03;
    errors.sonar.dropout_share = 0.10;
    errors.sonar.spurious_share = 0.02;
    errors.sonar.resolution_m = 0.01;
  }
}

// Sensors of a vehicle. The files say how the DVL is mounted by the drawing.
void drawVehicle(const Scenario& s, DiveErrors& errors) {
  const EffectSet& on = s.effects;
  errors.altimeter = errors.sonar;
  errors.altimeter.turn_rad_per_s = errors.altimeter.sector_rad = 0.0;
  errors.altimeter.nearest_m = 0.05;
  errors.altimeter.farthest_m = 50.0;
  Random random(s.seed, "dvl/specimen");
  const double scale = random.sign() * random.uniform(0.007, 0.013);
  const Quat misalignment = drawTurn(2.0 * kDegree, 3.5 * kDegree, random);
  if (on.has(Effect::DvlNoise)) {
    errors.dvl.velocity_noise_m_per_s = 0.006;
    errors.dvl.range_noise_m = 0.02;
    errors.current_sensor = kCurrentSensor;
  }
  if (on.has(Effect::DvlDropouts)) errors.dvl.dropout_share = 0.10;
  if (on.has(Effect::DvlSentinels)) errors.dvl.sentinel_share = 0.05;
  if (on.has(Effect::DvlScale)) errors.dvl.scale = scale;
  if (on.has(Effect::DvlMisalignment)) {
    Quat& rotation = errors.truth.rig.dvl->body_from_dvl.rotation;
    rotation = (rotation * misalignment).normalized();
  }
  std::vector<Vec3> fields = drawCurrentFields(s.seed, s.cables_moved);
  if (!on.has(Effect::ThrusterCurrents)) fields.assign(fields.size(), Vec3::Zero());
  errors.truth.rig.currents->fields_T_per_A = fields;
}

}  // namespace

DiveErrors drawErrors(const Scenario& s) {
  const EffectSet& on = s.effects;
  DiveErrors errors;
  errors.truth = s.vehicle ? vehicleRig(s.rig) : standardRig(s.rig);
  errors.imu = drawImuErrors(imuGrade(s.imu_grade),
                             {on.has(Effect::ImuNoise), on.has(Effect::ImuBias), on.has(Effect::ImuScale),
                              on.has(Effect::ImuWarmUp), on.has(Effect::GSensitivity)},
                             s.seed);
  errors.magnetometer =
      drawMagnetometerErrors(s.imu_grade,
                             {on.has(Effect::MagnetometerNoise), on.has(Effect::MagnetometerIron),
                              on.has(Effect::HardIronCreep), on.has(Effect::MagnetometerLag), s.duration_s},
                             s.seed);
  errors.truth.rig.magnetometer->body_from_magnetometer = errors.magnetometer.body_from_magnetometer;
  drawDepthAndSonar(s, errors);
  if (s.vehicle) drawVehicle(s, errors);
  drawClocks(s, errors);

  errors.in_water = errors.truth.rig;
  if (on.hasPort() && s.in_water) putBehindPort(on, s.seed, errors);
  if (on.hasPort() && !s.in_water) takeOutOfHousing(on, s.seed, errors);
  errors.given = errors.in_water;
  describeShutter(on, errors);
  if (on.has(Effect::CameraIntrinsics)) misstateIntrinsics(s.seed, errors.given);
  misstateExtrinsics(on, s.seed, errors.given);

  // Calibration files state a grade's noise for any effects, because no real file has a noise density of
  // zero.
  const ImuGrade& grade = imuGrade(s.imu_grade);
  errors.given.imu.noise = statedNoise({grade.gyroscope, grade.accelerometer});
  if (on.has(Effect::MagnetometerExtrinsics)) errors.given.magnetometer->body_from_magnetometer = Rigid3();
  errors.given.magnetometer->noise_density_T_per_sqrtHz =
      drawMagnetometerErrors(s.imu_grade, {}, s.seed).noise_density_T_per_sqrtHz;
  errors.given.pressure->depth_noise_std_m = 0.02;
  errors.given.sonar->range_noise_std_m = 0.05;
  if (s.vehicle) {
    errors.given.dvl->body_from_dvl = vehicleRig(s.rig).rig.dvl->body_from_dvl;
    errors.given.currents->fields_T_per_A.clear();
  }
  return errors;
}

}  // namespace lodeline
