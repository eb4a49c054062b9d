#pragma once

#include <optional>
#include <vector>

#include "lodeline/geometry/types.h"

namespace lodeline {

/// How a camera turned between two images, from the images alone.
struct VisualRotation {
  /// Rotation vector of previous_from_current_C, rad.
  Vec3 rotation_C = Vec3::Zero();
  int points = 0;        ///< that agree with it
  double rms_rad = 0.0;  ///< of their distance from their epipolar planes
};

/// Rotation and direction of translation that bring pairs of unit rays onto common epipolar planes, by robust
/// Gauss-Newton on f1 . (t x R f2) from the rotation that fits the rays best by itself: no knowledge of other
/// sensors enters. Nothing where fewer than `least_points` pairs agree.
std::optional<VisualRotation> visualRotation(const std::vector<Vec3>& previous,
                                             const std::vector<Vec3>& current, int least_points = 15);

}  // namespace lodeline
