#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lodeline/magnetometer/calibration/heading/gyroscope_path.h"

namespace lodeline {

/// Corrected field in magnetometer axes at one time.
struct NormalizedFieldSample {
  Time time;
  Vec3 field_M = Vec3::Zero();  ///< in units of the field's size
};

/// How the magnetometer sits on the IMU, and how late it is, from how the field turned.
struct FieldAlignment {
  Quat body_from_magnetometer = Quat::Identity();
  double time_offset_s = 0.0;  ///< stamps + this = IMU clock
  Vec3 gyroscope_bias_B = Vec3::Zero();
  /// RMS of the disagreement over `step_s`, per axis, in units of the field's size.
  double residual = 0.0;
  /// Second smallest by smallest eigenvalue of the problem: near one, the motion does not tell.
  double distinctness = 0.0;
};

struct FieldAlignmentOptions {
  double step_s = 0.2;  ///< over which turns are compared
  double greatest_time_offset_s = 0.1;
  int most_pairs = 3000;
};

/// While the body turns by dR (body 1 from body 2), a field that is constant in the world obeys
///   R z_2 = dR^T R z_1,   R = R_B_M,
/// which is linear in R: the null vector of the stacked equations, made a rotation. It needs turns about two
/// axes at least and no first guess. The time offset is found where the disagreement is least, the gyroscope
/// bias from its linear part. Since the equations hold for -R as well, a left-handed sensor frame comes out
/// as one with the field reversed. Nothing where fewer than 20 pairs of samples lie within the readings.
std::optional<FieldAlignment> alignField(std::span<const NormalizedFieldSample> field,
                                         std::span<const ImuSample> imu,
                                         const FieldAlignmentOptions& options = {});

}  // namespace lodeline
