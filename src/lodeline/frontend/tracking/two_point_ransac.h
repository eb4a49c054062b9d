#pragma once

#include <vector>

#include "lodeline/types.h"

namespace lodeline {

struct TwoPointRansacOptions {
  double max_error_px = 1.5;
  /// Sigma of the given rotation, because the gyroscope bias is not yet known.
  double rotation_sigma_rad = 0.005;
  int hypotheses = 60;
  int seed = 1;  ///< of the choice of hypotheses
};

/// Inlier test: which pairs of bearings agree with one motion of the camera between two images.
///
/// The rotation is approximately known; two pairs then give the direction of the translation (the common
/// perpendicular of their epipolar planes). The best of a fixed number of seeded hypotheses is refined
/// together with the rotation by robust Gauss-Newton. The criterion is the distance of a pair from its
/// epipolar plane. For a camera without translation every direction fits, so nothing is rejected. Fewer than
/// 8 pairs are not tested.
///
/// `previous`, `current`: unit rays of the same points in each image's camera frame. `focal_px` converts
/// angles to pixels.
std::vector<bool> twoPointRansac(const std::vector<Vec3>& previous, const std::vector<Vec3>& current,
                                 const Mat3& current_from_previous, double focal_px,
                                 const TwoPointRansacOptions& options);

}  // namespace lodeline
