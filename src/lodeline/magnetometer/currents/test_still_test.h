#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "lodeline/geometry/so3.h"
#include "lodeline/magnetometer/currents/still_record.h"

namespace lodeline::test {

struct StillTestOptions {
  unsigned seed = 1;
  std::vector<Vec3> fields_T_per_A = {{0.4e-6, -0.1e-6, 0.2e-6},
                                      {-0.3e-6, 0.35e-6, 0.1e-6},
                                      {0.05e-6, 0.2e-6, -0.5e-6},
                                      {0.02e-6, -0.04e-6, 0.03e-6}};
  std::vector<double> largest_A = {20.0, 20.0, 20.0, 3.0};
  double ramp_s = 12.0;      ///< of each channel, one after the other, twice
  double noise_T = 0.05e-6;  ///< of a reading
  double lag_s = 0.0;        ///< the currents' stamps are early by this
  double drift_T_per_s = 2e-9;
  double sway_rad = 0.0;     ///< about a horizontal and the vertical axis
  double spike_share = 0.0;  ///< of readings, off by 20 uT
  bool together = false;     ///< the first two channels run as one
  bool battery = false;      ///< the last channel is the sum of all, with its own ramp
  bool with_imu = true;
};

/// Current of a channel at a time, A, without those that a battery carries for others.
inline double ownCurrent_A(const StillTestOptions& options, size_t channel, double time_s) {
  const size_t turn = options.together && channel == 1 ? 0 : channel;
  const double cycle_s = options.ramp_s * static_cast<double>(options.largest_A.size());
  const double at = std::fmod(time_s - 2.0, cycle_s) / options.ramp_s - static_cast<double>(turn);
  if (time_s < 2.0 || at < 0.0 || at > 0.9) return 0.0;
  return options.largest_A[channel] * std::clamp(3.0 * std::min(at, 0.9 - at), 0.0, 1.0);
}

inline double rampCurrent_A(const StillTestOptions& options, size_t channel, double time_s) {
  double current_A = ownCurrent_A(options, channel, time_s);
  if (!options.battery || channel + 1 < options.largest_A.size()) return current_A;
  for (size_t i = 0; i < channel; ++i) current_A += ownCurrent_A(options, i, time_s);
  return current_A;
}

/// A vehicle that is held while each thruster runs up and down, twice.
inline StillTest makeStillTest(const StillTestOptions& options) {
  std::mt19937 random(options.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const Time start = Time::fromNanoseconds(1'700'000'000'000'000'000);
  const double duration_s = 4.0 + 2.0 * options.ramp_s * static_cast<double>(options.largest_A.size());
  const Vec3 field_W(3e-6, 23e-6, -38e-6), gravity_W(0.0, 0.0, 9.80665);
  const auto rotation = [&](double time_s) {
    return so3::exp(options.sway_rad * std::sin(0.7 * time_s) * Vec3(0.6, 0.0, 0.8)) *
           so3::exp(Vec3(0.1, -0.05, 1.0));
  };
  StillTest test;
  for (size_t i = 0; i < options.largest_A.size(); ++i)
    test.channels.push_back("motor_" + std::to_string(i + 1));
  for (int i = 0; i < static_cast<int>(50.0 * duration_s); ++i) {
    const double time_s = i / 50.0 + 0.003;
    Vec3 field_M = rotation(time_s).conjugate() * field_W + Vec3(5e-6, -2e-6, 1e-6) +
                   options.drift_T_per_s * time_s * Vec3(1.0, -0.5, 0.3);
    for (size_t c = 0; c < options.largest_A.size(); ++c)
      field_M += rampCurrent_A(options, c, time_s) * options.fields_T_per_A[c];
    field_M += options.noise_T * Vec3(normal(random), normal(random), normal(random));
    if (uniform(random) < options.spike_share) field_M.x() += 20e-6;
    test.magnetometer.push_back({start + Duration::fromSeconds(time_s), field_M});
  }
  for (int i = 0; i < static_cast<int>(10.0 * duration_s); ++i) {
    const double time_s = i / 10.0;
    CurrentSample& sample = test.currents.emplace_back();
    sample.time = start + Duration::fromSeconds(time_s - options.lag_s);
    for (size_t c = 0; c < options.largest_A.size(); ++c)
      sample.currents_A.push_back(rampCurrent_A(options, c, time_s) + 0.02 * normal(random));
  }
  for (int i = 0; options.with_imu && i < static_cast<int>(100.0 * duration_s); ++i) {
    const double time_s = i / 100.0;
    constexpr double kStep_s = 1e-3;
    const Vec3 rate_B =
        so3::log(rotation(time_s - kStep_s).conjugate() * rotation(time_s + kStep_s)) / (2.0 * kStep_s);
    const Vec3 noise(normal(random), normal(random), normal(random));
    test.imu.push_back({start + Duration::fromSeconds(time_s),
                        rate_B + Vec3(2e-3, -1e-3, 5e-4) + 1e-3 * noise,
                        rotation(time_s).conjugate() * gravity_W});
  }
  return test;
}

}  // namespace lodeline::test
