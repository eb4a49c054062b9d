#pragma once

#include "lodeline/imu/preintegration.h"
#include "lodeline/types.h"

namespace lodeline {

/// Motion of the body from the time of a ping to that of its frame, from inertial readings. R and v are
/// attitude and velocity of the frame. The body at the time of the ping moves with
///   u = gamma R^T (v - g elapsed) - beta                    m/s, axes of the body at the ping.
/// gamma and beta are those of a Preintegration over that time. Both follow changes of the biases to first
/// order: gamma(b_g + d) = exp(rotation_by_gyroscope_bias d) gamma.
struct PingMotion {
  double elapsed_s = 0.0;
  Quat rotation = Quat::Identity();     ///< gamma: body at the ping from body at the frame
  Vec3 velocity_change = Vec3::Zero();  ///< beta, m/s
  Vec3 rate_B = Vec3::Zero();           ///< the gyroscope's reading at the ping, rad/s
  Vec3 gyroscope_bias_B = Vec3::Zero();
  Vec3 accelerometer_bias_B = Vec3::Zero();
  Mat3 rotation_by_gyroscope_bias = Mat3::Zero();
  Mat3 velocity_by_gyroscope_bias = Mat3::Zero();
  Mat3 velocity_by_accelerometer_bias = Mat3::Zero();
  double sigma_m_per_s = 0.0;  ///< of beta, each axis

  /// For a ping at the time of the frame.
  PingMotion() = default;
  /// `interval` leads from the ping to the frame.
  PingMotion(const Preintegration& interval, const Vec3& rate_at_ping_B);

  Quat rotationFor(const Vec3& gyroscope_bias) const;
  Vec3 velocityChangeFor(const Vec3& gyroscope_bias, const Vec3& accelerometer_bias) const {
    return velocity_change + velocity_by_gyroscope_bias * (gyroscope_bias - gyroscope_bias_B) +
           velocity_by_accelerometer_bias * (accelerometer_bias - accelerometer_bias_B);
  }
};

}  // namespace lodeline
