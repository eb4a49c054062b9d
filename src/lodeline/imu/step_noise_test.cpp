#include "lodeline/imu/step_noise.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

ImuSample reading(double time_s, const Vec3& rate, const Vec3& force) {
  return {Time::fromSeconds(time_s), rate, force};
}

const Vec3 kUp(0.0, 0.0, 9.80665);
const Vec3 kBias(0.01, -0.02, 0.03);

TEST(StepNoise, OfASensorAtRestIsItsDensitiesInflated) {
  const ImuNoise noise;
  const StepNoise at_rest =
      stepNoise(reading(0.0, kBias, kUp), reading(0.005, kBias, kUp), kBias, noise, 3.0, {});
  EXPECT_DOUBLE_EQ(std::sqrt(at_rest.gyroscope), 3.0 * noise.gyroscope_density_rad_per_s_sqrtHz);
  EXPECT_DOUBLE_EQ(std::sqrt(at_rest.accelerometer), 3.0 * noise.accelerometer_density_m_per_s2_sqrtHz);
  EXPECT_DOUBLE_EQ(std::sqrt(at_rest.gyroscope_walk), 3.0 * noise.gyroscope_random_walk_rad_per_s2_sqrtHz);
  EXPECT_DOUBLE_EQ(std::sqrt(at_rest.accelerometer_walk),
                   3.0 * noise.accelerometer_random_walk_m_per_s3_sqrtHz);
}

// 0.2 % of 1 rad/s for half a second is 1 mrad, which is a random walk of 1 mrad / sqrt(0.5 s).
TEST(StepNoise, OfATurnComesFromTheAxes) {
  const MotionNoiseOptions options{0.0, 0.002, 0.5};
  const ImuNoise quiet{1e-12, 1e-12, 1e-12, 1e-12};
  const Vec3 turning = kBias + Vec3(0.6, 0.0, 0.8);
  const StepNoise noise =
      stepNoise(reading(0.0, turning, kUp), reading(0.005, turning, kUp), kBias, quiet, 1.0, options);
  EXPECT_NEAR(std::sqrt(noise.gyroscope * 0.5), 1e-3, 1e-9);
  EXPECT_NEAR(std::sqrt(noise.accelerometer_walk * 0.5), 9.80665e-3, 1e-8);
  EXPECT_NEAR(noise.accelerometer, 0.0, 1e-20);
  EXPECT_NEAR(noise.gyroscope_walk, 0.0, 1e-20);
}

// The mean over a step has an error of the given fraction of the change: density^2 / h = (fraction *
// change)^2.
TEST(StepNoise, OfVibrationComesFromWhatTheReadingsDoNotResolve) {
  const MotionNoiseOptions options{0.1, 0.0, 0.3};
  const ImuNoise quiet{1e-12, 1e-12, 1e-12, 1e-12};
  const StepNoise noise = stepNoise(reading(0.0, Vec3::Zero(), kUp),
                                    reading(0.005, Vec3(0.0, 0.3, 0.0), kUp + Vec3(2.0, 0.0, 0.0)),
                                    Vec3::Zero(), quiet, 1.0, options);
  EXPECT_NEAR(std::sqrt(noise.gyroscope / 0.005), 0.03, 1e-9);
  EXPECT_NEAR(std::sqrt(noise.accelerometer / 0.005), 0.2, 1e-9);
}

TEST(StepNoise, WithoutMotionNoiseIsThatOfTheDensities) {
  const ImuNoise noise;
  const StepNoise moving =
      stepNoise(reading(0.0, Vec3(1.0, 0.0, 0.0), kUp), reading(0.005, Vec3(0.0, 2.0, 0.0), Vec3::Zero()),
                Vec3::Zero(), noise, 1.0, MotionNoiseOptions::none());
  EXPECT_DOUBLE_EQ(std::sqrt(moving.gyroscope), noise.gyroscope_density_rad_per_s_sqrtHz);
  EXPECT_DOUBLE_EQ(std::sqrt(moving.accelerometer_walk), noise.accelerometer_random_walk_m_per_s3_sqrtHz);
}

}  // namespace
}  // namespace lodeline
