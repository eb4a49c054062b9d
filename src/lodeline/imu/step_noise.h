#pragma once

#include "lodeline/geometry/types.h"
#include "lodeline/sensors/measurements.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// What motion adds to an IMU's noise at rest. All four figures describe a kind of sensor and mounting, not
/// one recording; docs/inertial.md has the measurements behind them.
struct MotionNoiseOptions {
  /// Share of the change from one reading to the next that counts as unknown: motion and vibration which the
  /// sampling does not resolve. One sigma, white from step to step.
  double unresolved_share = 0.095;
  /// Scale errors and misalignment of the axes, relative: what a factory calibration leaves.
  double axis_error = 0.004;
  /// How long a turn keeps its sense, s: an axis error stays the same error for so long, then counts as a new
  /// one.
  double axis_error_time_s = 0.3;

  /// A sensor that is exactly what its noise densities say, as in simulation.
  static MotionNoiseOptions none() { return {0.0, 0.0, 0.3}; }
};

/// Noise over one step between two readings, as variance densities (squares of ImuNoise's units).
struct StepNoise {
  double gyroscope = 0.0;           ///< (rad/s)^2/Hz
  double accelerometer = 0.0;       ///< (m/s^2)^2/Hz
  double gyroscope_walk = 0.0;      ///< (rad/s^2)^2/Hz
  double accelerometer_walk = 0.0;  ///< (m/s^3)^2/Hz
};

/// With readings w_0, w_1 and f_0, f_1 a step h apart, inflated densities s, unresolved share c, axis error m
/// and its time T, g = 9.80665 m/s^2:
///   gyroscope          s_g^2 + h c^2 |w_1 - w_0|^2 + T m^2 |w_1 - b_g|^2
///   accelerometer      s_a^2 + h c^2 |f_1 - f_0|^2
///   gyroscope walk     s_bg^2
///   accelerometer walk s_ba^2 + T (m g)^2 |w_1 - b_g|^2
/// The last: an axis error turns gravity into a bias that is constant only while the rig keeps its attitude.
StepNoise stepNoise(const ImuSample& from, const ImuSample& to, const Vec3& gyroscope_bias_B,
                    const ImuNoise& at_rest, double inflation, const MotionNoiseOptions& options);

}  // namespace lodeline
