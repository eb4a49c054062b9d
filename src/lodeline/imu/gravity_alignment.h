#pragma once

#include <span>

#include "lodeline/rig.h"
#include "lodeline/types.h"

namespace lodeline {

struct GravityAlignmentOptions {
  /// Thresholds of the stationary detector: scatter of the readings about their means (root mean square over
  /// the axes) and rate of rotation. The rate leaves room for a bias that is not estimated yet. A constant
  /// slow rotation about the vertical cannot be distinguished from a bias.
  double still_gyroscope_std_rad_per_s = 0.02;
  double still_specific_force_std_m_per_s2 = 0.15;
  double still_rate_rad_per_s = 0.15;
  /// Minimum span of the readings for a detection; a swimmer's readings also scatter little within a tenth of
  /// a second.
  double still_min_span_s = 0.5;

  /// Time after which slow disturbances of a stationary rig are independent.
  double correlation_s = 0.5;
  /// Motion of a rig that is not stationary, one sigma per axis. The mean acceleration over a span is the
  /// change of velocity divided by its length; the scatter of the readings may hide it. Both values fit fast
  /// flight (EuRoC V1_03): tilt errors of 6.8, 4.7 and 2.3 degrees for spans of 0.25, 1 and 2 s.
  double speed_sigma_m_per_s = 0.6;
  double acceleration_sigma_m_per_s2 = 1.2;
};

/// Attitude relative to gravity from the accelerometer.
struct GravityAlignment {
  /// At the last reading, with zero yaw: the horizontal projection of the body's x axis points along the
  /// world's x axis. Where x is steeper than 60 degrees, the z axis (then flatter than 30) is used instead.
  Quat world_from_body = Quat::Identity();
  /// One sigma of roll and of pitch for a known accelerometer bias (which tilts by bias / g), rad. It
  /// includes the scatter over the averaging time and, unless stationary, the unknown mean acceleration.
  double tilt_sigma_rad = 0.0;

  bool still = false;
  /// Mean gyroscope reading where the rig was stationary, otherwise the given bias, rad/s.
  Vec3 gyroscope_bias_B = Vec3::Zero();
  double gyroscope_std_rad_per_s = 0.0;
  double specific_force_std_m_per_s2 = 0.0;   ///< in the body frame
  Vec3 mean_specific_force_B = Vec3::Zero();  ///< in the frame of the last reading, m/s^2
};

/// Attitude (world from body, zero yaw as in GravityAlignment) of a body whose unit vector `up_B` points up.
Quat levelWithZeroYaw(const Vec3& up_B);

/// Averages the specific force of `samples`, each rotated by the gyroscope into the body frame of the last
/// one. A single reading is enough, with the uncertainty of a moving rig; it cannot be detected as
/// stationary. Throws InputError like Preintegration for unusable samples. Throws EstimationError where the
/// mean force is below half of gravity, as in free fall, because the vertical is then unknown.
GravityAlignment alignWithGravity(std::span<const ImuSample> samples, const Vec3& gyroscope_bias_B,
                                  const GravityAlignmentOptions& options = {});

}  // namespace lodeline
