#pragma once

#include <functional>
#include <vector>

#include "lodeline/mapping/graph/motion/relative_pose.h"
#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

struct PairwiseConsistencyOptions {
  /// Probability with which two true loops count as consistent: 3 sigma.
  double probability = 0.9973;

  void check() const;
};

/// The largest set of loops that agree with each other in pairs.
struct ConsistentLoops {
  std::vector<size_t> indices;  ///< into the loops, ascending
  bool is_largest = true;       ///< proved, see maximumClique()
};

/// Pose of the second keyframe in the first by odometry, within one dive.
using OdometryBetween = std::function<RelativePose(KeyframeId, KeyframeId)>;

/// The circuit through two loops a and b and the odometry between their ends: the pose of new_b in old_a by
/// new_a and by old_b, and the sum of the covariances of both ways.
struct Circuit {
  Rigid3 by_a, by_b;
  Mat6 covariance = Mat6::Zero();

  /// chi^2 of the difference of both ways, 6 degrees of freedom.
  double chiSquared() const { return mahalanobisSquared(by_a, by_b, covariance); }
};
Circuit circuitOf(const Loop& a, const Loop& b, const OdometryBetween& odometry);

/// Pairwise consistency maximization: J. G. Mangelson, D. Dominic, R. M. Eustice, R. Vasudevan, "Pairwise
/// consistent measurement set maximization for robust multi-robot map merging", ICRA 2018. All loops must
/// have their old keyframes in one dive and their new keyframes in one dive; both may be the same dive. One
/// loop alone is always consistent: the caller decides how many must agree.
ConsistentLoops largestConsistentSet(const std::vector<Loop>& loops, const OdometryBetween& odometry,
                                     const PairwiseConsistencyOptions& options = {});

}  // namespace lodeline
