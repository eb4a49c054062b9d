#pragma once

#include <optional>
#include <vector>

#include "lodeline/inspection/survey/gyroscope_integral.h"

namespace lodeline {

/// Rotation of a camera between two of its images.
struct CameraTurn {
  Time begin, end;             ///< stamps of the images, with the time offset of the calibration
  Vec3 rate_C = Vec3::Zero();  ///< rad/s, from the images alone
};

/// Comparison of a camera's rotations with those of the gyroscope.
struct TurnComparison {
  int turns = 0;             ///< used
  double correlation = 0.0;  ///< 0 to 1, at the best time offset, for any axes
  /// Root mean square of the rates about their means.
  double camera_rate_rad_per_s = 0.0, gyroscope_rate_rad_per_s = 0.0;
  double time_offset_s = 0.0;  ///< time stamps of the images + this = clock of the gyroscope
  double time_offset_sigma_s = 0.0;
  /// Least-squares matrix that maps the gyroscope's rate to the camera's, in body axes: identity where units,
  /// axes, extrinsics and focal length are correct. Zero along directions without rotation.
  Mat3 body_from_gyroscope = Mat3::Zero();
  /// The nearest orthonormal matrix; with determinant -1 where that fits much better.
  Mat3 axes = Mat3::Identity();
  bool is_mirrored = false;
  double gyroscope_scale = 1.0;  ///< ratio of the norms of the rates, camera to gyroscope
  /// Rotation vector (body axes, rad) from the calibrated to the observed orientation of the camera, as far
  /// as the motion determines it; `hidden_axes` counts the directions that it does not determine.
  Vec3 misalignment_B = Vec3::Zero();
  double misalignment_rad = 0.0;
  int hidden_axes = 0;
  /// Ratio of pan and tilt by the images to those by the gyroscope: true over calibrated focal length.
  double focal_ratio = 1.0;
  double focal_ratio_sigma = 1.0;
  /// Share of the variance of the camera's rates that the gyroscope explains: as calibrated, and with the
  /// best matrix.
  double explained = 0.0;
  double explained_at_best = 0.0;
};

/// Minimum amount of rotation for a comparison. Over a shorter time a rig rotates so smoothly that any two
/// signals correlate at some time shift.
struct TurnLimits {
  int turns = 25;
  double time_s = 4.0;
  double around_s = 0.0;      ///< middle of the offsets that are searched for
  bool searches_wide = true;  ///< for offsets of seconds, where no small one fits
};

/// Compares the rotations. Empty where too few of them are within the gyroscope's readings, their total time
/// is too short, or the camera hardly rotated.
std::optional<TurnComparison> compareTurns(const std::vector<CameraTurn>& turns,
                                           const GyroscopeIntegral& gyroscope, const Quat& body_from_camera,
                                           const TurnLimits& limits = {});

}  // namespace lodeline
