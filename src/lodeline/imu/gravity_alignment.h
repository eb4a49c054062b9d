#pragma once

#include <span>

#include "lodeline/geometry/types.h"
#include "lodeline/sensors/measurements.h"

namespace lodeline {

struct GravityAlignmentOptions {
  /// The rig counts as still when its readings scatter less than this about their means (root mean square
  /// over the axes) and it turns less than the rate below, which leaves room for a bias nobody has estimated
  /// yet. A steady slow turn about the vertical looks the same as a bias and cannot be told from it.
  double still_gyroscope_std_rad_per_s = 0.02;
  double still_specific_force_std_m_per_s2 = 0.15;
  double still_rate_rad_per_s = 0.15;
  /// Readings of a shorter span do not show stillness: a swimmer's scatter no more within a tenth of a
  /// second.
  double still_min_span_s = 0.5;

  /// Slow disturbances of a still rig count as independent after this time.
  double correlation_s = 0.5;
  /// Motion of a rig that is not still, one sigma per axis. The mean acceleration over a span is the change
  /// of velocity divided by its length, however little it shows in the scatter. Both fit fast flight (EuRoC
  /// V1_03): tilt errors of 6.8, 4.7 and 2.3 degrees for spans of 0.25, 1 and 2 s.
  double speed_sigma_m_per_s = 0.6;
  double acceleration_sigma_m_per_s2 = 1.2;
};

/// Which way is up, from the accelerometer.
struct GravityAlignment {
  /// At the last reading, with zero yaw: the horizontal projection of the body's x axis points along the
  /// world's x axis; where x is steeper than 60 degrees, the z axis (then flatter than 30) takes its place.
  Quat world_from_body = Quat::Identity();
  /// One sigma of roll and of pitch given the accelerometer's bias (which tilts by bias / g), rad: scatter
  /// over the time averaged and, unless still, the unknown mean acceleration.
  double tilt_sigma_rad = 0.0;

  bool still = false;
  /// The mean gyroscope reading where the rig was still, else the given bias, rad/s.
  Vec3 gyroscope_bias_B = Vec3::Zero();
  double gyroscope_std_rad_per_s = 0.0;
  double specific_force_std_m_per_s2 = 0.0;   ///< in the body frame
  Vec3 mean_specific_force_B = Vec3::Zero();  ///< in the frame of the last reading, m/s^2
};

/// Attitude (world from body, zero yaw as in GravityAlignment) of a body in whose frame the unit vector
/// `up_B` points up.
Quat levelWithZeroYaw(const Vec3& up_B);

/// Averages the specific force of `samples`, each turned by the gyroscope into the frame of the last one. A
/// single reading will do, with the uncertainty of a rig that moves; none shows stillness. Throws InputError
/// as Preintegration does for unusable samples, and EstimationError when the mean force is under half of
/// gravity, as in free fall, so that it says nothing about up.
GravityAlignment alignWithGravity(std::span<const ImuSample> samples, const Vec3& gyroscope_bias_B,
                                  const GravityAlignmentOptions& options = {});

}  // namespace lodeline
