#include "simulation/recording/sensor_recording.h"

#include <fmt/format.h>

#include <cmath>

#include "lodeline/geometry/so3.h"
#include "simulation/dive/vehicle_dive.h"
#include "simulation/recording/recording_files.h"
#include "simulation/recording/vehicle_recording.h"

namespace lodeline {
namespace {

std::string truthRow(Time time, const MotionState& state, const ImuModel& imu) {
  const Vec3& p = state.world_from_body.translation;
  const Quat q = so3::canonical(state.world_from_body.rotation);
  const Vec3& v = state.velocity_W;
  const Vec3& g = imu.gyroscopeBias();
  const Vec3& a = imu.accelerometerBias();
  return fmt::format(
      "{},{:.7f},{:.7f},{:.7f},{:.10f},{:.10f},{:.10f},{:.10f},{:.7f},{:.7f},{:.7f},"
      "{:.8g},{:.8g},{:.8g},{:.8g},{:.8g},{:.8g}\n",
      time.nanoseconds(), p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), v.x(), v.y(), v.z(), g.x(), g.y(),
      g.z(), a.x(), a.y(), a.z());
}

bool isAtRest(const Scenario& s) {
  return s.motion == MotionKind::AtRest || s.motion == MotionKind::CurrentRamps;
}

// Records inertial readings, and the true states with the biases of these readings.
void recordImu(const Dive& dive, const std::filesystem::path& mav0) {
  RecordingFile readings(mav0 / "imu0" / "data.csv");
  readings.write(kImuColumns);
  const std::filesystem::path truth_folder = mav0 / "state_groundtruth_estimate0";
  RecordingFile truth(truth_folder / "data.csv");
  truth.write(
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
      "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad "
      "s^-1], "
      "b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n");
  const double rate_hz = dive.scenario.rig.imu_rate_hz;
  const double truth_rate_hz = isAtRest(dive.scenario) ? 1.0 : 100.0;
  const Shaking shake = makeShaking(dive);
  const int64_t every = std::max<int64_t>(1, std::llround(rate_hz / truth_rate_hz));
  ImuModel imu(dive.errors.imu, rate_hz, noiseSeed(dive.scenario));
  for (int64_t i = 0;; ++i) {
    const double t = static_cast<double>(i) / rate_hz;
    if (t > dive.motion.duration_s()) break;
    const MotionState state = dive.motion.at(t);
    const Time stamp = dive.start + Duration::fromSeconds(t);
    ImuSample perfect = perfectImuSample(state, stamp, dive.gravity_W);
    if (shake) shake(t, &perfect);
    const ImuSample sample = imu.measure(perfect);
    const Vec3& w = sample.angular_velocity_B;
    const Vec3& f = sample.specific_force_B;
    readings.write(fmt::format("{},{:.10g},{:.10g},{:.10g},{:.10g},{:.10g},{:.10g}\n", stamp.nanoseconds(),
                               w.x(), w.y(), w.z(), f.x(), f.y(), f.z()));
    if (i % every == 0) truth.write(truthRow(stamp, state, imu));
  }
  readings.close();
  truth.close();
  RecordingFile sensor(truth_folder / "sensor.yaml");
  sensor.write(
      "sensor_type: visual-inertial\ncomment: true states of the simulated body in W (east, north, up)\n");
  sensor.close();
}

void recordMagnetometer(const Dive& dive, const std::filesystem::path& mav0) {
  const double rate_hz = dive.scenario.rig.magnetometer_rate_hz;
  MagnetometerModel model(dive.motion, dive.field_W, dive.disturbances, dive.errors.magnetometer, rate_hz,
                          noiseSeed(dive.scenario));
  RecordingFile file(mav0 / "mag0" / "data.csv");
  file.write(kMagnetometerColumns);
  // Half a period after the IMU's first reading, because the two sensors have no common trigger.
  for (int64_t i = 0;; ++i) {
    const double t = (static_cast<double>(i) + 0.5) / rate_hz;
    if (t > dive.motion.duration_s()) break;
    const Vec3 m = model.measure(t);
    file.write(fmt::format("{},{:.8e},{:.8e},{:.8e}\n", (dive.start + Duration::fromSeconds(t)).nanoseconds(),
                           m.x(), m.y(), m.z()));
  }
  file.close();
}

void recordDepth(const Dive& dive, const std::filesystem::path& mav0) {
  PressureModel model(dive.motion, dive.errors.truth.rig.pressure->body_from_pressure, dive.surface_height_m,
                      dive.errors.pressure, noiseSeed(dive.scenario));
  RecordingFile file(mav0 / "pressure0" / "data.csv");
  file.write(kDepthColumns);
  for (int64_t i = 0;; ++i) {
    const double t = (static_cast<double>(i) + 0.3) / dive.scenario.rig.pressure_rate_hz;
    if (t > dive.motion.duration_s()) break;
    file.write(
        fmt::format("{},{:.6f}\n", (dive.start + Duration::fromSeconds(t)).nanoseconds(), model.measure(t)));
  }
  file.close();
}

void recordSonar(const Dive& dive, const RangeFunction& range, const std::filesystem::path& mav0) {
  SonarModel model(dive.motion, dive.errors.truth.rig.sonar->body_from_sonar, range, dive.errors.sonar,
                   noiseSeed(dive.scenario));
  RecordingFile file(mav0 / "sonar0" / "data.csv");
  file.write(kSonarColumns);
  for (int64_t i = 0;; ++i) {
    const double t = (static_cast<double>(i) + 0.7) / dive.scenario.rig.sonar_rate_hz;
    if (t > dive.motion.duration_s()) break;
    const auto echo = model.measure(t);
    if (!echo) continue;
    file.write(fmt::format("{},{:.5f},{:.6f}\n", (dive.start + Duration::fromSeconds(t)).nanoseconds(),
                           echo->range_m, echo->angle_rad));
  }
  file.close();
}

}  // namespace

void recordSensors(const Dive& dive, const RangeFunction& range, const std::filesystem::path& folder) {
  const std::filesystem::path mav0 = folder / "mav0";
  const bool in_water = !isAtRest(dive.scenario);
  Rig given = dive.errors.given;
  if (!dive.scenario.images) given.cameras.clear();
  if (!in_water) given.pressure.reset();
  if (!range) {
    given.sonar.reset();
    given.altimeter.reset();
    given.dvl.reset();
  }
  writeCalibration(given, mav0);
  recordImu(dive, mav0);
  recordMagnetometer(dive, mav0);
  if (given.pressure) recordDepth(dive, mav0);
  if (given.sonar) recordSonar(dive, range, mav0);
  if (given.altimeter) recordAltimeter(dive, range, mav0);
  if (given.dvl) recordDvl(dive, range, mav0);
  if (given.currents) recordCurrents(dive, mav0);
}

}  // namespace lodeline
