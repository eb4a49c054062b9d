#pragma once

#include <optional>
#include <vector>

#include "lodeline/inspection/survey/gyroscope_integral.h"

namespace lodeline {

/// How a camera turned between two of its images.
struct CameraTurn {
  Time begin, end;             ///< stamps of the images, with the time offset of the calibration
  Vec3 rate_C = Vec3::Zero();  ///< rad/s, from the images alone
};

/// What the turns of a camera say of gyroscope and calibration together.
struct TurnComparison {
  int turns = 0;             ///< used
  double correlation = 0.0;  ///< 0 to 1, at the best time offset, whatever the axes
  /// Root mean square of the rates about their means.
  double camera_rate_rad_per_s = 0.0, gyroscope_rate_rad_per_s = 0.0;
  double time_offset_s = 0.0;  ///< stamps of the images + this = clock of the gyroscope
  double time_offset_sigma_s = 0.0;
  /// Least-squares matrix that turns the gyroscope's rate into the camera's, in body axes: identity where
  /// units, axes, extrinsics and focal length are right. Zero along directions without rotation.
  Mat3 body_from_gyroscope = Mat3::Zero();
  /// The orthonormal matrix nearest to it; of determinant -1 where that fits much better.
  Mat3 axes = Mat3::Identity();
  bool is_mirrored = false;
  double gyroscope_scale = 1.0;  ///< ratio of the sizes of the rates, camera to gyroscope
  /// Rotation vector (body axes, rad) from the calibrated to the observed direction of the camera, as far as
  /// the motion shows it; `hidden_axes` counts directions that it does not show.
  Vec3 misalignment_B = Vec3::Zero();
  double misalignment_rad = 0.0;
  int hidden_axes = 0;
  /// Ratio of pan and tilt as the images show them to the gyroscope's: true over calibrated focal length.
  double focal_ratio = 1.0;
  double focal_ratio_sigma = 1.0;
  /// Share of the variance of the camera's rates that the gyroscope explains as calibrated, and at best.
  double explained = 0.0;
  double explained_at_best = 0.0;
};

/// What turns must amount to. Over a shorter time a rig turns so smoothly that anything correlates with
/// anything, somewhat shifted.
struct TurnLimits {
  int turns = 25;
  double time_s = 4.0;
};

/// Nothing where too few turns lie within the gyroscope's readings, they last too short a time, or the camera
/// hardly turned.
std::optional<TurnComparison> compareTurns(const std::vector<CameraTurn>& turns,
                                           const GyroscopeIntegral& gyroscope, const Quat& body_from_camera,
                                           const TurnLimits& limits = {});

}  // namespace lodeline
