#include "lodeline/imu/noise/imu_noise_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace lodeline {
namespace {

constexpr double kPeriod_s = 0.005;

/// Readings of a rig that sways, then rests, with these white noise densities.
std::vector<ImuSample> readings(double gyroscope, double accelerometer, double resolution = 0.0) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const double root_rate = std::sqrt(1.0 / kPeriod_s);
  std::vector<ImuSample> samples;
  for (int i = 0; i < 1000; ++i) {
    const double t = i * kPeriod_s, sway = i < 600 ? 0.5 * std::sin(6.0 * t) : 0.0;
    ImuSample sample{Time::fromSeconds(t), Vec3(sway, -sway, 0.0), Vec3(3.0 * sway, 0.0, 9.8)};
    for (int axis = 0; axis < 3; ++axis) {
      sample.angular_velocity_B[axis] += gyroscope * root_rate * normal(random);
      sample.specific_force_B[axis] += accelerometer * root_rate * normal(random);
    }
    if (resolution > 0.0) {
      sample.angular_velocity_B = (sample.angular_velocity_B / resolution).array().round() * resolution;
    }
    samples.push_back(sample);
  }
  return samples;
}

TEST(WhiteNoise, IsThatOfTheQuietestMoment) {
  const WhiteNoise shown = whiteNoiseOf(readings(1.0e-4, 2.0e-3));
  EXPECT_NEAR(shown.gyroscope_rad_per_s_sqrtHz, 1.0e-4, 0.2e-4);
  EXPECT_NEAR(shown.accelerometer_m_per_s2_sqrtHz, 2.0e-3, 0.4e-3);
}

TEST(WhiteNoise, OfACoarseSensorIsThatOfItsResolution) {
  const double resolution = 0.02;
  const WhiteNoise shown = whiteNoiseOf(readings(1.0e-6, 2.0e-3, resolution));
  EXPECT_NEAR(shown.gyroscope_rad_per_s_sqrtHz, resolution * std::sqrt(kPeriod_s / 12.0), 1e-6);
}

TEST(WhiteNoise, OfAShakenSensorIsUnknown) {
  const WhiteNoise shown = whiteNoiseOf(readings(5.0e-3, 0.1));
  EXPECT_EQ(shown.gyroscope_rad_per_s_sqrtHz, 0.0);
  EXPECT_EQ(shown.accelerometer_m_per_s2_sqrtHz, 0.0);
}

TEST(PlausibleNoise, LeavesFiguresThatFitAsTheyAre) {
  const ImuNoise stated;
  Diagnostics diagnostics;
  for (const WhiteNoise& shown : {WhiteNoise(), WhiteNoise{1.0e-4, 1.5e-3}, WhiteNoise{4.0e-4, 5.0e-3}}) {
    const ImuNoise noise = plausibleNoise(stated, shown, &diagnostics);
    EXPECT_EQ(noise.gyroscope_density_rad_per_s_sqrtHz, stated.gyroscope_density_rad_per_s_sqrtHz);
    EXPECT_EQ(noise.gyroscope_random_walk_rad_per_s2_sqrtHz, stated.gyroscope_random_walk_rad_per_s2_sqrtHz);
    EXPECT_EQ(noise.accelerometer_density_m_per_s2_sqrtHz, stated.accelerometer_density_m_per_s2_sqrtHz);
    EXPECT_EQ(noise.accelerometer_random_walk_m_per_s3_sqrtHz,
              stated.accelerometer_random_walk_m_per_s3_sqrtHz);
  }
  EXPECT_TRUE(diagnostics.ranked().empty());
}

TEST(PlausibleNoise, RaisesWhatNoSensorHas) {
  const ImuNoise nearly_zero{1.7e-10, 1.9e-11, 2e-9, 3e-9};
  Diagnostics diagnostics;
  const ImuNoise common;
  const ImuNoise blind = plausibleNoise(nearly_zero, {}, &diagnostics);
  EXPECT_EQ(blind.gyroscope_density_rad_per_s_sqrtHz, common.gyroscope_density_rad_per_s_sqrtHz);
  EXPECT_EQ(blind.accelerometer_density_m_per_s2_sqrtHz, common.accelerometer_density_m_per_s2_sqrtHz);
  EXPECT_NEAR(blind.gyroscope_random_walk_rad_per_s2_sqrtHz, 1.7e-5, 1e-9);
  EXPECT_NEAR(blind.accelerometer_random_walk_m_per_s3_sqrtHz, 2e-4, 1e-9);
  EXPECT_EQ(diagnostics.count("imu_noise_too_small"), 4);
  const ImuNoise seen = plausibleNoise(nearly_zero, {5.0e-5, 1.0e-3}, &diagnostics);
  EXPECT_NEAR(seen.gyroscope_density_rad_per_s_sqrtHz, 7.5e-5, 1e-9);
  EXPECT_NEAR(seen.accelerometer_density_m_per_s2_sqrtHz, 1.5e-3, 1e-9);
}

TEST(PlausibleNoise, RaisesATenthOfWhatTheReadingsShow) {
  const ImuNoise tenth{1.7e-5, 1.9e-6, 2e-4, 3e-4};
  Diagnostics diagnostics;
  const ImuNoise noise = plausibleNoise(tenth, {1.0e-4, 1.4e-3}, &diagnostics);
  EXPECT_NEAR(noise.gyroscope_density_rad_per_s_sqrtHz, 1.5e-4, 1e-9);
  EXPECT_NEAR(noise.accelerometer_density_m_per_s2_sqrtHz, 2.1e-3, 1e-9);
  ASSERT_EQ(diagnostics.ranked().size(), 1u);
  EXPECT_EQ(diagnostics.ranked().front().severity, Severity::Warning);
}

TEST(PlausibleNoise, TellsOfFiguresThatAreTooLargeAndKeepsThem) {
  const ImuNoise large{1.7e-3, 1.9e-4, 2e-2, 3e-2};
  Diagnostics diagnostics;
  const ImuNoise noise = plausibleNoise(large, {1.0e-4, 1.4e-3}, &diagnostics);
  EXPECT_EQ(noise.gyroscope_density_rad_per_s_sqrtHz, 1.7e-3);
  ASSERT_EQ(diagnostics.count("imu_noise_too_large"), 2);
  EXPECT_EQ(diagnostics.ranked().front().severity, Severity::Notice);
}

TEST(PlausibleNoise, SaysNothingOfSimulatedReadingsWithoutNoise) {
  Diagnostics diagnostics;
  plausibleNoise(ImuNoise(), {1e-7, 1e-6}, &diagnostics);
  EXPECT_TRUE(diagnostics.ranked().empty());
}

}  // namespace
}  // namespace lodeline
