#pragma once

#include <optional>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Rotation of a camera between two images, from the images alone.
struct VisualRotation {
  /// Rotation vector of previous_from_current_C, rad.
  Vec3 rotation_C = Vec3::Zero();
  int points = 0;        ///< number of inliers
  double rms_rad = 0.0;  ///< of the distance from their epipolar planes
};

/// Rotation and direction of translation for which pairs of unit rays are on common epipolar planes, by
/// robust Gauss-Newton on f1 . (t x R f2). The initial rotation is the one that fits the rays best without
/// translation; other sensors are not used. Empty where fewer than `least_points` pairs agree.
std::optional<VisualRotation> visualRotation(const std::vector<Vec3>& previous,
                                             const std::vector<Vec3>& current, int least_points = 15);

}  // namespace lodeline
