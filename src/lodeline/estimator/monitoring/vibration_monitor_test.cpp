#include "lodeline/estimator/monitoring/vibration_monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "simulation/shared/random.h"

namespace lodeline {
namespace {

constexpr double kRate_hz = 100.0, kInflation = 2.0;

Rig vehicle() {
  Rig rig;
  rig.imu.rate_hz = kRate_hz;
  rig.imu.noise.accelerometer_density_m_per_s2_sqrtHz = 2e-3;
  rig.dvl.emplace();
  return rig;
}

/// Seconds of readings in intervals between frames, with ends that are interpolated; white noise as stated, a
/// swimmer's motion, and a shake of the force along x.
void addShaken(double begin_s, double end_s, double amplitude_m_per_s2, double frequency_hz,
               VibrationMonitor* monitor, double noise_times = 1.0, double rate_hz = kRate_hz) {
  Random random(static_cast<uint64_t>(1.0 + begin_s), "vibration test");
  const double sigma = noise_times * 2e-3 * std::sqrt(rate_hz);
  const auto at = [&](double t) {
    return ImuSample{Time::fromSeconds(t), Vec3(0.0, 0.0, 0.3 * std::sin(3.0 * t)),
                     Vec3(0.5 * std::sin(6.0 * t) +
                              amplitude_m_per_s2 * std::sin(2.0 * std::numbers::pi * frequency_hz * t),
                          0.0, 9.8) +
                         sigma * random.normal3()};
  };
  std::vector<ImuSample> readings;
  for (int i = static_cast<int>(begin_s * rate_hz); i < end_s * rate_hz; ++i) {
    readings.push_back(at(i / rate_hz));
    if (i % 12 != 11) continue;
    // The frame is between two readings.
    readings.push_back(at((i + 0.4) / rate_hz));
    monitor->add(readings);
    readings = {readings.back()};
  }
  monitor->add(readings);
}

double forceDensity(const VibrationMonitor& monitor) {
  return monitor.doubt().accelerometer_density_m_per_s2_sqrtHz;
}

TEST(VibrationMonitor, AddsNothingToNoiseAndMotion) {
  for (const double noise_times : {1.0, 4.0}) {
    VibrationMonitor monitor(vehicle(), kInflation);
    addShaken(0.0, 20.0, 0.0, 0.0, &monitor, noise_times);
    EXPECT_FALSE(monitor.doubt().any()) << noise_times;
  }
}

// A frequency of a third of the rate has 1.5 times its variance in v; all of it is noise of one axis out of
// three.
TEST(VibrationMonitor, AddsTheStrengthOfAVibration) {
  VibrationMonitor monitor(vehicle(), kInflation);
  addShaken(0.0, 20.0, 0.6, 100.0 / 3.0, &monitor);
  const double variance = 1.5 * 0.5 * 0.6 * 0.6 / 3.0 + 4e-4;
  EXPECT_NEAR(forceDensity(monitor), std::sqrt(variance / kRate_hz - std::pow(3.0 * kInflation * 2e-3, 2)),
              2e-3);
  EXPECT_EQ(monitor.doubt().gyroscope_density_rad_per_s_sqrtHz, 0.0);
  EXPECT_EQ(monitor.doubt().accelerometer_bias_step_m_per_s2, 0.0);
}

// Folded to 30 Hz.
TEST(VibrationMonitor, SeesAFrequencyAboveHalfTheRate) {
  VibrationMonitor folded(vehicle(), kInflation), plain(vehicle(), kInflation);
  addShaken(0.0, 20.0, 0.6, 70.0, &folded);
  addShaken(0.0, 20.0, 0.6, 30.0, &plain);
  EXPECT_GT(forceDensity(folded), 0.02);
  EXPECT_NEAR(forceDensity(folded), forceDensity(plain), 1e-3);
}

TEST(VibrationMonitor, RemembersForSecondsAndForgets) {
  VibrationMonitor monitor(vehicle(), kInflation);
  addShaken(0.0, 10.0, 0.6, 35.0, &monitor);
  const double strong = forceDensity(monitor);
  // A frequency that folds to zero does not show.
  addShaken(10.0, 11.0, 0.6, 100.0, &monitor);
  EXPECT_GT(forceDensity(monitor), 0.5 * strong);
  addShaken(11.0, 25.0, 0.0, 0.0, &monitor);
  EXPECT_FALSE(monitor.doubt().any());
}

TEST(VibrationMonitor, DoesNothingWithoutASensorOfAVehicleAndWithAFastImu) {
  Rig diver = vehicle(), fast = vehicle();
  diver.dvl.reset();
  fast.imu.rate_hz = 2.0 * kRate_hz;
  for (const Rig& rig : {diver, fast}) {
    VibrationMonitor monitor(rig, kInflation);
    addShaken(0.0, 10.0, 0.6, 35.0, &monitor, 1.0, rig.imu.rate_hz);
    EXPECT_FALSE(monitor.doubt().any());
  }
}

}  // namespace
}  // namespace lodeline
