#pragma once

#include <optional>
#include <vector>

#include "lodeline/imu/preintegration.h"
#include "lodeline/problem/state/measurement.h"
#include "lodeline/types.h"

namespace lodeline {

/// Gyroscope bias (rad/s) with which the preintegrated rotations agree with those of the visual structure, by
/// least squares over all intervals. Interval i leads from `rotations[i]` to `rotations[i + 1]` (any frame
/// from body). The preintegrations are integrated again with the result.
Vec3 alignGyroscopeBias(const std::vector<Quat>& rotations, const std::vector<Preintegration*>& intervals);

/// Velocities of frames by other sensors; empty for a frame without one.
using MeasuredVelocities = std::vector<std::optional<CarriedVelocity>>;

struct VisualInertialAlignment {
  double scale = 1.0;              ///< metres per unit of the visual structure
  Vec3 gravity_V = Vec3::Zero();   ///< m/s^2, in the visual structure's axes, of the given magnitude
  std::vector<Vec3> velocities_V;  ///< m/s, one per frame
  Vec3 accelerometer_bias_B = Vec3::Zero();  ///< m/s^2
  /// Magnitude of gravity from the linear system without the constraint on it, m/s^2: a plausibility check.
  double free_gravity_magnitude = 0.0;
};

/// Estimates scale, gravity and velocities from a visual structure of arbitrary scale (camera positions and
/// body rotations in its axes V) and preintegrated motion. It also estimates the accelerometer bias with a
/// zero-mean prior of `bias_sigma_m_per_s2`. `measured`: velocities by other sensors, one per frame or none
/// at all. Linear least squares come first, then the magnitude of gravity is enforced (Qin, Li & Shen,
/// "VINS-Mono", TRO 2018, section V-B, who neglect the bias). Empty where the system is singular (motion
/// without acceleration does not determine the scale) or the scale is negative.
std::optional<VisualInertialAlignment> alignVisualInertial(
    const std::vector<Quat>& visual_from_body, const std::vector<Vec3>& camera_positions_V,
    const Vec3& camera_position_B, const std::vector<Preintegration*>& intervals, double gravity_magnitude,
    double bias_sigma_m_per_s2, const MeasuredVelocities& measured = {});

}  // namespace lodeline
