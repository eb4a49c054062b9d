#pragma once

#include <span>

#include "lodeline/rig.h"
#include "lodeline/types.h"

namespace lodeline {

/// One reading in body axes, corrected for soft and hard iron. The time is that of the measurement.
struct FieldSample {
  Time time;
  Vec3 field_B = Vec3::Zero();  ///< T
};

/// Mean of the magnetometer readings before one moment, each rotated to that moment with the gyroscope. With
/// a constant field m_W and a residual offset o_B of the corrected readings,
///   field_B = R_B_W m_W + carried * o_B + noise.
struct MagnetometerMean {
  Time time;
  Vec3 field_B = Vec3::Zero();      ///< mean, T, body axes at `time`
  Mat3 carried = Mat3::Identity();  ///< mean rotation, body at `time` from body at the readings
  Vec3 newest_B = Vec3::Zero();     ///< the last reading alone, rotated to `time`
  int readings = 0;
  /// Rotation error, one sigma per axis, rad: the gyroscope's white noise between the readings and `time`.
  /// All readings of one mean share it.
  double rotation_sigma_rad = 0.0;
};

/// Rotates the samples to `time` and averages them. `samples` (at least one) and `imu` are in order of time.
/// The IMU readings must cover all samples up to `time`, the time of the last one. The rate is the measured
/// one minus `gyroscope_bias_B`, linear in time between readings. `gyroscope_density`: rad/s/sqrt(Hz). Throws
/// InputError where the IMU does not cover the samples.
MagnetometerMean carryToFrame(std::span<const FieldSample> samples, std::span<const ImuSample> imu,
                              const Vec3& gyroscope_bias_B, double gyroscope_density);

}  // namespace lodeline
