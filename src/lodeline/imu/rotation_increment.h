#pragma once

#include "lodeline/geometry/so3.h"

namespace lodeline {

/// Angular velocity of the body at one moment, body axes.
struct TurningRate {
  Vec3 rate_rad_per_s;
  Vec3 slope_rad_per_s2;  ///< its time derivative
};

/// Rotation over an interval in which the rate is a cubic in time with the given end values and slopes:
/// exp(rotation_vector) = body at start from body at end. It uses the first two terms of the Magnus
/// expansion, with an error of fifth order in the interval. Source: Blanes et al., "The Magnus expansion and
/// some of its applications", Physics Reports 2009, section 2. The slopes matter where a rig rotates about
/// two axes out of phase (coning): without them, the error of each interval is of third order and
/// accumulates.
struct RotationIncrement {
  Vec3 rotation_vector;  ///< rad
  Mat3 by_bias;          ///< derivative by a bias subtracted from both rates, s
  Vec3 mean_rate_rad_per_s;

  /// Rate linear in time between both values, rad/s.
  RotationIncrement(const Vec3& from, const Vec3& to, double stretch_s)
      : RotationIncrement(TurningRate{from, Vec3::Zero()}, TurningRate{to, Vec3::Zero()}, stretch_s) {}

  RotationIncrement(const TurningRate& from, const TurningRate& to, double stretch_s)
      : rotation_vector(
            0.5 * stretch_s * (from.rate_rad_per_s + to.rate_rad_per_s) +
            stretch_s * stretch_s / 12.0 *
                (from.slope_rad_per_s2 - to.slope_rad_per_s2 + from.rate_rad_per_s.cross(to.rate_rad_per_s))),
        by_bias(-stretch_s * Mat3::Identity() +
                stretch_s * stretch_s / 12.0 * so3::skew(to.rate_rad_per_s - from.rate_rad_per_s)),
        mean_rate_rad_per_s(0.5 * (from.rate_rad_per_s + to.rate_rad_per_s) +
                            stretch_s / 12.0 * (from.slope_rad_per_s2 - to.slope_rad_per_s2)) {}
};

}  // namespace lodeline
