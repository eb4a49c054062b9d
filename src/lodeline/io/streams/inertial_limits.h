#pragma once

#include <algorithm>

#include "lodeline/rig.h"

/// Limits of inertial readings that no sensor can exceed.
namespace lodeline::inertial_limits {

/// Limits above the largest ranges of IMUs on the market: 4000 deg/s = 70 rad/s, and 40 g = 392 m/s^2.
constexpr double kRate_rad_per_s = 80.0;
constexpr double kForce_m_per_s2 = 450.0;

inline double largest(const Vec3& reading) { return reading.cwiseAbs().maxCoeff(); }

/// Whether a reading is within the limits. `rate_to_SI` converts its angular rate where the unit is not
/// settled.
inline bool isPossible(const ImuSample& sample, double rate_to_SI = 1.0) {
  return sample.angular_velocity_B.allFinite() && sample.specific_force_B.allFinite() &&
         largest(sample.angular_velocity_B) * rate_to_SI <= kRate_rad_per_s &&
         largest(sample.specific_force_B) <= kForce_m_per_s2;
}

/// Whether all six values are exactly zero. Noise and gravity exclude this for a working sensor.
inline bool isZero(const ImuSample& sample) {
  return sample.angular_velocity_B.isZero(0.0) && sample.specific_force_B.isZero(0.0);
}

}  // namespace lodeline::inertial_limits
