#include "simulation/vehicle/still_ramps.h"

#include <algorithm>

#include "simulation/motion/posed_motion.h"
#include "simulation/sensors/imu_model.h"

namespace lodeline {
namespace {

constexpr double kThrusterCurrent_A = 20.0;
constexpr double kElectronics_A = 1.5;
constexpr double kMoreElectronics_A = 3.0;
constexpr int kRamps = kThrusters + kLamps + 1;

}  // namespace

double RampTimes::duration_s() const { return before_s + kRamps * each_s(); }

LoadsFunction rampedLoads(const RampTimes& times) {
  return [times](double t) {
    // Share of the largest current of a channel.
    const auto share = [&](int channel) {
      const double since_s = t - times.before_s - channel * times.each_s();
      const double until_s = 2.0 * times.ramp_s + times.hold_s - since_s;
      return std::clamp(std::min(since_s, until_s) / times.ramp_s, 0.0, 1.0);
    };
    ElectricLoads loads;
    for (int i = 0; i < kThrusters; ++i) loads.thrusters_A[i] = kThrusterCurrent_A * share(i);
    for (int i = 0; i < kLamps; ++i) loads.lamps_A[i] = kLampCurrent_A * share(kThrusters + i);
    loads.electronics_A = kElectronics_A + kMoreElectronics_A * share(kRamps - 1);
    return loads;
  };
}

StillRamps simulateStillRamps(const StillRampsOptions& o) {
  const double duration_s = o.times.duration_s();
  const Motion motion = makeMotionAtRest(o.seed, duration_s, Rigid3());
  const LoadsFunction loads = rampedLoads(o.times);
  StillRamps test;
  test.world_from_body = motion.at(0.0).world_from_body;
  test.true_currents.rate_hz = o.current_rate_hz;
  test.true_currents.channels = currentChannels();
  test.true_currents.fields_T_per_A = drawCurrentFields(o.seed, o.cables_moved);
  MagnetometerSpecimenOptions specimen;
  specimen.noise = o.noise;
  test.magnetometer_errors = drawMagnetometerErrors(o.imu_grade, specimen, o.seed);

  MagneticDisturbances disturbances;
  disturbances.currents_M = [&](double t) {
    return fieldOfCurrents(test.true_currents.fields_T_per_A, channelCurrents(loads(t)));
  };
  // The second day has other noise.
  const uint64_t noise_seed = o.seed + (o.cables_moved ? 1'000'003u : 0u);
  const auto stampOf = [&](double t) { return o.start + Duration::fromSeconds(t); };
  ImuModel imu(drawImuErrors(imuGrade(o.imu_grade), {o.noise, true}, o.seed), o.imu_rate_hz, noise_seed);
  for (int i = 0; i / o.imu_rate_hz <= duration_s; ++i) {
    const double t = i / o.imu_rate_hz;
    test.imu.push_back(imu.measure(perfectImuSample(motion.at(t), stampOf(t), Vec3(0.0, 0.0, -9.80665))));
  }
  MagnetometerModel magnetometer(motion, o.field_W, disturbances, test.magnetometer_errors,
                                 o.magnetometer_rate_hz, noise_seed);
  for (int i = 0; (i + 0.5) / o.magnetometer_rate_hz <= duration_s; ++i) {
    const double t = (i + 0.5) / o.magnetometer_rate_hz;
    test.magnetometer.push_back({stampOf(t), magnetometer.measure(t)});
  }
  CurrentSensorModel sensor(loads, o.noise ? kCurrentSensor : CurrentSensorErrors{}, noise_seed);
  for (int i = 0; (i + 0.2) / o.current_rate_hz <= duration_s; ++i) {
    const double t = (i + 0.2) / o.current_rate_hz;
    test.currents.push_back({stampOf(t), sensor.measure(t)});
  }
  return test;
}

}  // namespace lodeline
