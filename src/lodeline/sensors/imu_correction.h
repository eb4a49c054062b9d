#pragma once

#include <algorithm>

#include "lodeline/sensors/measurements.h"

namespace lodeline {

/// Calibrated scale, misalignment and bias of an IMU, and the correction of its readings. The measurement
/// model is Kalibr's with constant biases:
///
///     gyroscope reading     = G^-1 w + S f + b_g        accelerometer reading = F^-1 f + b_a
///
/// with the angular velocity w (rad/s) and the specific force f (m/s^2) in body axes.
struct ImuCorrection {
  Mat3 accelerometer = Mat3::Identity();  ///< F
  Mat3 gyroscope = Mat3::Identity();      ///< G, includes the rotation from the gyroscope's axes to B
  Mat3 g_sensitivity = Mat3::Zero();      ///< S, rad/s per m/s^2
  Vec3 accelerometer_bias = Vec3::Zero();
  Vec3 gyroscope_bias = Vec3::Zero();
  /// Offset added to IMU stamps to obtain the clock of the cameras' offsets (Kalibr's time_offset).
  double time_offset_s = 0.0;

  ImuSample applied(const ImuSample& reading) const {
    ImuSample sample;
    sample.time = reading.time + Duration::fromSeconds(time_offset_s);
    sample.specific_force_B = accelerometer * (reading.specific_force_B - accelerometer_bias);
    sample.angular_velocity_B =
        gyroscope * (reading.angular_velocity_B - gyroscope_bias - g_sensitivity * sample.specific_force_B);
    return sample;
  }

  /// Largest relative change of a single-axis reading caused by scale and misalignment.
  double largestChange() const {
    const double force = (accelerometer - Mat3::Identity()).cwiseAbs().maxCoeff();
    return std::max(force, (gyroscope - Mat3::Identity()).cwiseAbs().maxCoeff());
  }
  bool isIdentity() const {
    return largestChange() == 0.0 && g_sensitivity.isZero(0.0) && accelerometer_bias.isZero(0.0) &&
           gyroscope_bias.isZero(0.0) && time_offset_s == 0.0;
  }
};

}  // namespace lodeline
