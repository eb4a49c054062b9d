#pragma once

#include <optional>
#include <vector>

#include "lodeline/geometry/rigid3.h"
#include "lodeline/imu/preintegration.h"

namespace lodeline {

/// Gyroscope bias that makes the preintegrated rotations agree with those of visual structure, by least
/// squares over all intervals; interval i leads from `rotations[i]` to `rotations[i + 1]` (any frame from
/// body). The preintegrations are integrated again at the result, rad/s.
Vec3 alignGyroscopeBias(const std::vector<Quat>& rotations, const std::vector<Preintegration*>& intervals);

struct VisualInertialAlignment {
  double scale = 1.0;              ///< metres per unit of the visual structure
  Vec3 gravity_V = Vec3::Zero();   ///< m/s^2, in the visual structure's axes, of the given magnitude
  std::vector<Vec3> velocities_V;  ///< m/s, one a frame
  Vec3 accelerometer_bias_B = Vec3::Zero();  ///< m/s^2
  /// Of the gravity that the linear system finds when its magnitude is left free, m/s^2: a plausibility
  /// check.
  double free_gravity_magnitude = 0.0;
};

/// Scale, gravity and velocities from visual structure with arbitrary scale (camera positions and body
/// rotations in its axes V) and preintegrated motion, beside the accelerometer's bias as far as its prior
/// (none, to `bias_sigma_m_per_s2`) lets it. Linear least squares first, then with the magnitude of gravity
/// enforced (Qin, Li & Shen, "VINS-Mono", TRO 2018, section V-B, who neglect the bias). Nothing where the
/// system is singular (motion without acceleration says nothing of scale) or the scale comes out negative.
std::optional<VisualInertialAlignment> alignVisualInertial(const std::vector<Quat>& visual_from_body,
                                                           const std::vector<Vec3>& camera_positions_V,
                                                           const Vec3& camera_position_B,
                                                           const std::vector<Preintegration*>& intervals,
                                                           double gravity_magnitude,
                                                           double bias_sigma_m_per_s2);

}  // namespace lodeline
