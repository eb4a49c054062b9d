#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lodeline/magnetometer/calibration/heading/gyroscope_path.h"

namespace lodeline {

/// Corrected field in the magnetometer frame M at one time.
struct NormalizedFieldSample {
  Time time;
  Vec3 field_M = Vec3::Zero();  ///< in units of the field magnitude
};

/// Rotation of the magnetometer relative to the IMU and its time offset, estimated from field and gyroscope.
struct FieldAlignment {
  Quat body_from_magnetometer = Quat::Identity();
  double time_offset_s = 0.0;  ///< stamps + this = IMU clock
  Vec3 gyroscope_bias_B = Vec3::Zero();
  /// RMS disagreement over `step_s`, per axis, in units of the field magnitude.
  double residual = 0.0;
  /// Ratio of the second smallest to the smallest eigenvalue; near one, the motion does not determine the
  /// rotation.
  double distinctness = 0.0;
};

struct FieldAlignmentOptions {
  double step_s = 0.2;  ///< interval over which rotations are compared
  double greatest_time_offset_s = 0.1;
  int most_pairs = 3000;
};

/// Estimates rotation and time offset from the motion. While the body rotates by dR (body 1 from body 2), a
/// constant field satisfies
///   R z_2 = dR^T R z_1,   R = R_B_M,
/// which is linear in R. The solution is the null vector of the stacked equations, projected to a rotation.
/// It needs rotations about at least two axes but no initial value. The time offset minimizes the
/// disagreement; the gyroscope bias follows from the linear part of the disagreement. The equations also hold
/// for -R, so a left-handed sensor frame gives a right-handed one with the field reversed. Returns nothing
/// where fewer than 20 pairs of samples are within the readings.
std::optional<FieldAlignment> alignField(std::span<const NormalizedFieldSample> field,
                                         std::span<const ImuSample> imu,
                                         const FieldAlignmentOptions& options = {});

}  // namespace lodeline
