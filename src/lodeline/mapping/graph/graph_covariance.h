#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <vector>

#include "lodeline/mapping/graph/motion/relative_pose.h"
#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// Covariances of a graph's nodes at one estimate: columns of the inverse of the normal matrix, computed for
/// the nodes that are asked for from one sparse Cholesky factorization. Errors are [dp, dtheta] in world
/// axes.
class GraphCovariance {
 public:
  struct Factorization;  ///< of the normal matrix, with the place of each node in it

  explicit GraphCovariance(std::shared_ptr<const Factorization> factorization);

  /// Covariance of one node. Zero in directions in which it is held.
  Mat6 of(KeyframeId node) const;
  /// Joint covariance of nodes, 6 rows each, in the order given.
  Eigen::MatrixXd joint(const std::vector<KeyframeId>& nodes) const;
  /// Pose of `to` in `from`, and its covariance in axes of `from`.
  RelativePose relative(KeyframeId from, KeyframeId to) const;

 private:
  std::shared_ptr<const Factorization> factorization_;
};

}  // namespace lodeline
