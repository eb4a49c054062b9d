#include "simulation/vehicle/thruster_vibration.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "simulation/shared/random.h"

namespace lodeline {

ThrusterVibration::ThrusterVibration(std::function<Thrusts(double time_s)> thrusts,
                                     const VibrationOptions& options, uint64_t seed)
    : thrusts_(std::move(thrusts)), options_(options) {
  Random random(seed, "vehicle/vibration");
  for (int i = 0; i < kThrusters; ++i) {
    force_axis_B_[i] = random.direction();
    rate_axis_B_[i] = random.direction();
    phase_rad_[i] = random.uniform(0.0, 2.0 * std::numbers::pi);
  }
}

ThrusterVibration::Shake ThrusterVibration::at(double time_s) {
  const Thrusts thrusts = thrusts_(time_s);
  Shake shake;
  for (int i = 0; i < kThrusters; ++i) {
    const double share = std::min(1.0, std::abs(thrusts[i]) / options_.largest_thrust_N);
    const double frequency_hz =
        options_.slowest_hz + (options_.fastest_hz - options_.slowest_hz) * std::sqrt(share);
    if (started_) {
      phase_rad_[i] +=
          std::numbers::pi * (frequency_hz_[i] + frequency_hz) * (time_s - last_s_);  // trapezoid
    }
    frequency_hz_[i] = frequency_hz;
    const double wave =
        share * (std::sin(phase_rad_[i]) + options_.harmonic_share * std::sin(2.0 * phase_rad_[i]));
    shake.specific_force_B += options_.acceleration_m_per_s2 * wave * force_axis_B_[i];
    shake.angular_velocity_B += options_.rate_rad_per_s * wave * rate_axis_B_[i];
  }
  started_ = true;
  last_s_ = time_s;
  return shake;
}

}  // namespace lodeline
