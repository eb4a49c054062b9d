#pragma once

#include <span>

#include "lodeline/rig_calibration/problem/rig_problem.h"

namespace lodeline {

/// Readings from one time to another, interpolated at both ends; empty where they do not cover the time, or
/// where readings are missing for longer than `longest_gap_s`.
std::vector<ImuSample> readingsBetween(std::span<const ImuSample> imu, Time from, Time to,
                                       double longest_gap_s);

/// The reading at a time by linear interpolation; nothing outside the recording.
std::optional<ImuSample> readingAt(std::span<const ImuSample> imu, Time time);

/// First values of delay, rotation between IMU and cameras, gyroscope bias, gravity and velocities.
struct InertialStart {
  double delay_s = 0.0;
  Quat body_from_camera = Quat::Identity();  ///< of the first camera
  Vec3 gyroscope_bias_B = Vec3::Zero();
  double rate_error_rad_per_s = 0.0;  ///< rms of what remains between the rates of camera and gyroscope
  /// Least standard deviation of the angular velocity along any axis, rad/s.
  double least_rate_rad_per_s = 0.0;
};

/// Aligns the turns between frames with the gyroscope's: the delay and the rotation with the least squares of
/// the differences (K. S. Arun, T. S. Huang, S. D. Blostein, "Least-squares fitting of two 3-D point sets",
/// PAMI 1987, for the rotation). Throws EstimationError where too few turns can be compared.
InertialStart alignRates(const RigState& cameras, std::span<const ImuSample> imu, double most_delay_s);

/// Takes a solution of the cameras alone to the IMU: bodies become the IMU, the world becomes level.
void enterInertialFrame(const InertialStart& start, std::span<const ImuSample> imu, RigState* state);

/// Integrates the readings between the frames with the present biases, and sets the frames' readings. Frames
/// outside of the readings are removed.
InertialLinks linkFrames(std::span<const ImuSample> imu, const ImuCalibration& calibration,
                         double noise_inflation, RigState* state);

}  // namespace lodeline
