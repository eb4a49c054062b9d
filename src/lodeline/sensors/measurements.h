#pragma once

#include "lodeline/geometry/types.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

/// One reading of the gyroscope and accelerometer in the body frame B (= IMU frame).
struct ImuSample {
  Time time;
  Vec3 angular_velocity_B = Vec3::Zero();  ///< rad/s, biased
  Vec3 specific_force_B = Vec3::Zero();    ///< m/s^2, biased; +9.8 along up at rest
  /// Time between the real readings on both sides of the step that ends here, s; 0 where it equals the step.
  /// An interpolated sample within a gap keeps the length of the whole gap, in which the motion is unknown.
  double gap_s = 0.0;
};

/// One raw magnetometer reading in the magnetometer frame M.
struct MagnetometerSample {
  Time time;
  Vec3 field_M = Vec3::Zero();  ///< T
};

/// One depth reading from a pressure sensor.
struct DepthSample {
  Time time;
  double depth_m = 0.0;  ///< positive down
};

/// One echo of a pencil-beam scanning sonar.
struct SonarSample {
  Time time;
  double range_m = 0.0;
  double angle_rad = 0.0;  ///< angle of the beam about the axis of the sonar head
};

}  // namespace lodeline
