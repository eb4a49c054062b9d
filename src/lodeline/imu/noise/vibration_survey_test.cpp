#include "lodeline/imu/noise/vibration_survey.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace lodeline {
namespace {

constexpr double kNoise_m_per_s2 = 0.02, kLimit_m_per_s2 = 0.1;

/// A minute at 100 Hz: a swimmer's motion, white noise, and a shake of this frequency from `from_s` on.
std::vector<ImuSample> shaken(double amplitude_m_per_s2, double frequency_hz, double from_s) {
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0.0, kNoise_m_per_s2);
  std::vector<ImuSample> samples;
  for (int i = 0; i < 6000; ++i) {
    const double t = 0.01 * i;
    const double motion = 0.5 * std::sin(2.0 * std::numbers::pi * 1.5 * t);
    const double shake =
        t < from_s ? 0.0 : amplitude_m_per_s2 * std::sin(2.0 * std::numbers::pi * frequency_hz * t);
    samples.push_back({Time::fromSeconds(t), Vec3::Zero(),
                       Vec3(noise(generator) + motion, noise(generator), 9.8 + noise(generator) + shake)});
  }
  return samples;
}

Vibration surveyed(const std::vector<ImuSample>& samples) {
  return surveyVibration(samples, &ImuSample::specific_force_B, kLimit_m_per_s2);
}

TEST(VibrationSurvey, DoesNotTakeNoiseAndMotionForVibration) {
  const Vibration vibration = surveyed(shaken(0.0, 0.0, 0.0));
  EXPECT_NEAR(vibration.strong, kNoise_m_per_s2, 0.2 * kNoise_m_per_s2);
  EXPECT_EQ(vibration.share, 0.0);
  EXPECT_NEAR(vibration.rate_hz, 100.0, 0.1);
}

TEST(VibrationSurvey, FindsTheShareOfTheTimeAndTheFrequency) {
  const Vibration vibration = surveyed(shaken(0.6, 35.0, 30.0));
  EXPECT_NEAR(vibration.share, 0.5, 0.02);
  EXPECT_NEAR(vibration.quiet, kNoise_m_per_s2, 0.3 * kNoise_m_per_s2);
  EXPECT_GT(vibration.strong, 0.2);
  EXPECT_NEAR(vibration.frequency_hz, 35.0, 2.0);
}

TEST(VibrationSurvey, ShowsAFrequencyBeyondHalfTheRateFolded) {
  const Vibration vibration = surveyed(shaken(0.6, 72.0, 0.0));
  EXPECT_GT(vibration.share, 0.98);
  EXPECT_NEAR(vibration.frequency_hz, 28.0, 2.0);
}

TEST(VibrationSurvey, SaysNothingOfTooFewReadings) {
  std::vector<ImuSample> samples = shaken(0.6, 35.0, 0.0);
  samples.resize(300);
  EXPECT_EQ(surveyed(samples).strong, 0.0);
  EXPECT_EQ(surveyed({}).rate_hz, 0.0);
}

}  // namespace
}  // namespace lodeline
