#pragma once

#include <array>
#include <functional>
#include <memory>

#include "lodeline/rig.h"
#include "simulation/vehicle/vehicle_thrust.h"

namespace lodeline {

struct VibrationOptions {
  double slowest_hz = 20.0;  ///< frequency of a thruster at rest
  double fastest_hz = 80.0;  ///< at the largest thrust
  double largest_thrust_N = 50.0;
  double acceleration_m_per_s2 = 0.6;  ///< amplitude of one thruster at the largest thrust
  double rate_rad_per_s = 0.008;       ///< the same of the gyroscope
  double harmonic_share = 0.4;         ///< amplitude of the double frequency relative to the single one
};

/// Vibration of the thrusters at the IMU. Thruster i shakes the IMU with
///   a_i sin(phi_i) + share * a_i sin(2 phi_i),   phi_i' = 2 pi f_i,
/// The frequency f_i follows the speed of the propeller, which grows with the square root of the thrust.
/// The amplitude a_i follows the thrust. Readings are samples of it, so what is above half the rate of
/// the IMU appears at another frequency. The displacement is below 40 um and no part of the true motion.
class ThrusterVibration {
 public:
  ThrusterVibration(std::function<Thrusts(double time_s)> thrusts, const VibrationOptions& options,
                    uint64_t seed);

  /// Specific force (m/s^2) and angular velocity (rad/s) in B.
  struct Shake {
    Vec3 specific_force_B = Vec3::Zero();
    Vec3 angular_velocity_B = Vec3::Zero();
  };
  /// At `time_s`; call it in order of time.
  Shake at(double time_s);

 private:
  std::function<Thrusts(double time_s)> thrusts_;
  VibrationOptions options_;
  std::array<Vec3, kThrusters> force_axis_B_, rate_axis_B_;
  std::array<double, kThrusters> phase_rad_, frequency_hz_ = {};
  bool started_ = false;
  double last_s_ = 0.0;
};

}  // namespace lodeline
