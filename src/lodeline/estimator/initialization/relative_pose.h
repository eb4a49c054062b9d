#pragma once

#include <optional>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// One point observed from two camera positions.
struct BearingPair {
  Vec3 bearing_a = Vec3::UnitZ();  ///< unit ray, camera frame at a
  Vec3 bearing_b = Vec3::UnitZ();
};

/// Median angle (rad) between the rays after the rotation that fits them best (Wahba's problem by SVD), i.e.
/// the part that only a translation can explain. Zero for fewer than 3 pairs.
double parallaxAfterBestRotation(const std::vector<BearingPair>& pairs);

/// Motion between two views of a rigid scene, up to scale: b_from_a with a translation of length 1.
/// Five-point algorithm in RANSAC with a fixed seed; empty when fewer than `min_inliers` pairs agree.
std::optional<Rigid3> estimateRelativePose(const std::vector<BearingPair>& pairs, double max_error_rad,
                                           int min_inliers);

}  // namespace lodeline
