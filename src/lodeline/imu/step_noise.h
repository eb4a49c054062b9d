#pragma once

#include "lodeline/rig.h"
#include "lodeline/types.h"

namespace lodeline {

/// Increase of an IMU's noise by motion relative to its noise at rest. The values apply to a kind of sensor
/// and mounting, not to one recording; docs/lab-notes/inertial.md has the measurements.
struct MotionNoiseOptions {
  /// Fraction of the change between consecutive readings that is unknown: motion and vibration that the
  /// sampling does not resolve. One sigma, white from step to step.
  double unresolved_share = 0.095;
  /// Relative scale errors and misalignment of the axes after a factory calibration.
  double axis_error = 0.004;
  /// Typical duration of a rotation in one sense, s. An axis error causes a constant error for this time,
  /// then an independent one.
  double axis_error_time_s = 0.3;

  /// No increase, for a simulated sensor that follows its noise densities exactly.
  static MotionNoiseOptions none() { return {0.0, 0.0, 0.3}; }
};

/// Noise over one step between two readings, as variance densities (squares of ImuNoise's units).
struct StepNoise {
  double gyroscope = 0.0;           ///< (rad/s)^2/Hz
  double accelerometer = 0.0;       ///< (m/s^2)^2/Hz
  double gyroscope_walk = 0.0;      ///< (rad/s^2)^2/Hz
  double accelerometer_walk = 0.0;  ///< (m/s^3)^2/Hz
};

/// Computes the noise of a step. The readings w_0, w_1 and f_0, f_1 have the interval h. s are the
/// inflated densities, c is the unresolved share, m the axis error and T its time, g = 9.80665 m/s^2:
///   gyroscope          s_g^2 + h c^2 |w_1 - w_0|^2 + T m^2 |w_1 - b_g|^2
///   accelerometer      s_a^2 + h c^2 |f_1 - f_0|^2
///   gyroscope walk     s_bg^2
///   accelerometer walk s_ba^2 + T (m g)^2 |w_1 - b_g|^2
/// The last term: through an axis error, gravity causes a bias that is constant only while the attitude is
/// constant.
StepNoise stepNoise(const ImuSample& from, const ImuSample& to, const Vec3& gyroscope_bias_B,
                    const ImuNoise& at_rest, double inflation, const MotionNoiseOptions& options);

}  // namespace lodeline
