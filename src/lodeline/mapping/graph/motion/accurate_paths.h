#pragma once

#include <map>
#include <vector>

#include "lodeline/mapping/graph/motion/relative_pose.h"
#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// Covariances of relative poses along single paths of a graph. A path leaves measurements out, so its
/// covariance is never smaller than that of the graph's solution. Of all paths, the one with the least sum of
/// variances counts, where rotations have a lever arm of 10 m (Dijkstra's algorithm).
class AccuratePaths {
 public:
  /// Adds an edge, which paths take in both directions.
  void add(KeyframeId from, KeyframeId to, const RelativePose& relative);

  /// Covariance of the pose of each target in `from`, in axes of `from`. Targets that no path reaches are
  /// left out.
  std::map<KeyframeId, Mat6> from(KeyframeId from, const std::vector<KeyframeId>& targets) const;

 private:
  struct Way {
    size_t to = 0;
    double cost = 0.0;
    RelativePose relative;
  };
  size_t place(KeyframeId id);

  std::map<KeyframeId, size_t> index_;
  std::vector<std::vector<Way>> ways_;  ///< from each node
};

}  // namespace lodeline
