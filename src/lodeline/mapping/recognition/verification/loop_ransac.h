#pragma once

#include <optional>
#include <vector>

#include "lodeline/mapping/recognition/verification/loop_pose.h"

namespace lodeline {

/// A pose with the pairs that agree with it.
struct ConsensusPose {
  Rigid3 old_from_new;
  std::vector<bool> is_inlier;
  int inliers = 0;
};

/// Pose on which most pairs agree, by random samples of two pairs and the known vertical of both keyframes
/// (posesOfTwoPoints). Each pose that is better than all before is refined with its inliers (LO-RANSAC, O.
/// Chum, J. Matas and J. Kittler, DAGM 2003). The cost is the sum of the squared residuals, each at most its
/// gate (MSAC). Only pairs with `is_used` take part. The samples are the same in every call. Empty where no
/// sample gives a pose with more than two inliers.
std::optional<ConsensusPose> findConsensus(const std::vector<LoopCorrespondence>& pairs,
                                           const std::vector<bool>& is_used, const MapKeyframe& old_keyframe,
                                           const MapKeyframe& new_keyframe);

/// The pairs with `is_used` that agree with a pose.
ConsensusPose consensusAt(const std::vector<LoopCorrespondence>& pairs, const std::vector<bool>& is_used,
                          const Rigid3& old_from_new);

}  // namespace lodeline
