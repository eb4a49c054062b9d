#pragma once

#include <vector>

#include "lodeline/geometry/types.h"

namespace lodeline {

struct TwoPointRansacOptions {
  double max_error_px = 1.5;
  /// How far the rotation may be off, as the gyroscope's bias is not yet known.
  double rotation_sigma_rad = 0.005;
  int hypotheses = 60;
  int seed = 1;  ///< of the choice of hypotheses
};

/// Which pairs of bearings agree with one motion of the camera between two images.
///
/// The rotation is known nearly; two pairs then give the direction of translation (the common perpendicular
/// of their epipolar planes). The best of a fixed number of seeded hypotheses is refined with the rotation
/// by robust Gauss-Newton, and pairs are judged by their distance from the epipolar plane. A camera that
/// stands still or only turns makes every translation fit, so nothing is rejected then. Fewer than 8 pairs
/// are not judged.
///
/// `previous`, `current`: unit rays of the same points in each image's camera frame. `focal_px` turns angles
/// into pixels.
std::vector<bool> twoPointRansac(const std::vector<Vec3>& previous, const std::vector<Vec3>& current,
                                 const Mat3& current_from_previous, double focal_px,
                                 const TwoPointRansacOptions& options);

}  // namespace lodeline
