#pragma once

#include <span>

#include "lodeline/geometry/types.h"
#include "lodeline/sensors/measurements.h"

namespace lodeline {

/// One reading freed from soft and hard iron, in body axes, stamped with the moment at which it was sensed.
struct FieldSample {
  Time time;
  Vec3 field_B = Vec3::Zero();  ///< T
};

/// What the magnetometer says of one moment: readings from before it, each carried there by the gyroscope.
/// With a constant field m_W and an offset o_B that the correction of the readings left behind,
///   field_B = R_B_W m_W + carried * o_B + noise.
struct MagnetometerMean {
  Time time;
  Vec3 field_B = Vec3::Zero();      ///< mean, T, axes of the body at `time`
  Mat3 carried = Mat3::Identity();  ///< mean rotation from the body at the readings to that at `time`
  Vec3 newest_B = Vec3::Zero();     ///< the last reading alone, carried likewise
  int readings = 0;
  /// Of the carrying, one sigma per axis, rad: the gyroscope's white noise between the readings and `time`,
  /// which the readings of one mean share.
  double rotation_sigma_rad = 0.0;
};

/// `samples` (at least one) and `imu` in order of time; the readings of the IMU cover all samples up to
/// `time`, where the last one lies. Turns at the rate measured less `gyroscope_bias_B`, linear in time
/// between readings. `gyroscope_density`: rad/s/sqrt(Hz). Throws InputError where the IMU does not cover the
/// samples.
MagnetometerMean carryToFrame(std::span<const FieldSample> samples, std::span<const ImuSample> imu,
                              const Vec3& gyroscope_bias_B, double gyroscope_density);

}  // namespace lodeline
