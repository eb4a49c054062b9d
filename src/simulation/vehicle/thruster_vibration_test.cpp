#include "simulation/vehicle/thruster_vibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace lodeline {
namespace {

// Power of a series at a frequency: |sum x_k e^(-i w t_k)|^2.
double powerAt(const std::vector<double>& series, double rate_hz, double frequency_hz) {
  double real = 0.0, imaginary = 0.0;
  for (size_t k = 0; k < series.size(); ++k) {
    const double angle = 2.0 * std::numbers::pi * frequency_hz * static_cast<double>(k) / rate_hz;
    real += series[k] * std::cos(angle);
    imaginary += series[k] * std::sin(angle);
  }
  return real * real + imaginary * imaginary;
}

double strongest_hz(double thrust_N, double rate_hz, const VibrationOptions& options) {
  ThrusterVibration vibration(
      [=](double) {
        Thrusts thrusts = {};
        thrusts[2] = thrust_N;
        return thrusts;
      },
      options, 1);
  std::vector<double> series;
  for (int k = 0; k < 1000; ++k) series.push_back(vibration.at(k / rate_hz).specific_force_B.x());
  double best_hz = 0.0, best = 0.0;
  for (double f = 0.5; f < 0.5 * rate_hz; f += 0.25) {
    const double power = powerAt(series, rate_hz, f);
    if (power > best) best = power, best_hz = f;
  }
  return best_hz;
}

TEST(ThrusterVibration, FrequencyFollowsTheSpeedOfThePropellerAndFoldsAtHalfTheRate) {
  VibrationOptions options;
  options.harmonic_share = 0.0;
  EXPECT_NEAR(strongest_hz(12.5, 200.0, options), 50.0, 0.3);
  EXPECT_NEAR(strongest_hz(50.0, 200.0, options), 80.0, 0.3);
  EXPECT_NEAR(strongest_hz(50.0, 100.0, options), 20.0, 0.3);  // 80 Hz read at 100 Hz
}

TEST(ThrusterVibration, AmplitudeFollowsTheThrust) {
  VibrationOptions options;
  options.harmonic_share = 0.0;
  const auto rms = [&](double thrust_N, bool gyroscope) {
    ThrusterVibration vibration(
        [=](double) {
          Thrusts thrusts = {};
          thrusts[0] = -thrust_N;
          return thrusts;
        },
        options, 1);
    double squares = 0.0;
    for (int k = 0; k < 4000; ++k) {
      const auto shake = vibration.at(k / 200.0);
      squares += (gyroscope ? shake.angular_velocity_B : shake.specific_force_B).squaredNorm();
    }
    return std::sqrt(squares / 4000.0);
  };
  EXPECT_EQ(rms(0.0, false), 0.0);
  EXPECT_NEAR(rms(25.0, false), 0.3 / std::numbers::sqrt2, 0.005);
  EXPECT_NEAR(rms(50.0, false), 0.6 / std::numbers::sqrt2, 0.01);
  EXPECT_NEAR(rms(50.0, true), 0.008 / std::numbers::sqrt2, 0.0002);
}

TEST(ThrusterVibration, SlowSamplingOfAChangingThrustIsTheFastOneThinnedOut) {
  const auto thrusts = [](double t) {
    Thrusts changing = {};
    for (int i = 0; i < kThrusters; ++i) changing[i] = 20.0 + 10.0 * std::sin(0.3 * t + i);
    return changing;
  };
  ThrusterVibration fast(thrusts, {}, 1), slow(thrusts, {}, 1);
  for (int k = 0; k <= 4000; ++k) {
    const Vec3 force = fast.at(k / 400.0).specific_force_B;
    if (k % 4 != 0) continue;
    EXPECT_LT((force - slow.at(k / 400.0).specific_force_B).norm(), 2e-3);
  }
}

}  // namespace
}  // namespace lodeline
