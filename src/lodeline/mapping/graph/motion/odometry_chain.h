#pragma once

#include <map>
#include <vector>

#include "lodeline/mapping/graph/motion/relative_pose.h"
#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// Relative poses by odometry between any two keyframes of one dive, each in constant time. The chain sums
/// the covariances of its edges once, carried to the origin of the odometry world:
///   S_n = sum_k B_k Q_k B_k^T,  B_k = [I, [p_k+1]x; 0, I] diag(R_k, R_k),
/// where R_k, p_k is the pose of keyframe k. The error that arose between i and j has the covariance S_j -
/// S_i there, which is carried to p_j and turned into axes of i.
class OdometryChain {
 public:
  /// Adds the first keyframe, with its pose in the odometry world.
  void start(KeyframeId id, const Rigid3& odom_from_body);
  /// Adds the next keyframe by the edge from the newest one. Throws InputError for a known identifier.
  void extend(KeyframeId id, const RelativePose& newest_from_next);

  bool contains(KeyframeId id) const { return index_.count(id) > 0; }
  size_t size() const { return poses_.size(); }
  /// Pose of `to` in `from` with its covariance, in either order. Throws InputError for unknown keyframes.
  RelativePose relative(KeyframeId from, KeyframeId to) const;

 private:
  size_t indexOf(KeyframeId id) const;

  std::map<KeyframeId, size_t> index_;
  std::vector<Rigid3> poses_;     ///< odom_from_body
  std::vector<Mat6> covariance_;  ///< S_n, relative to the first keyframe
};

}  // namespace lodeline
