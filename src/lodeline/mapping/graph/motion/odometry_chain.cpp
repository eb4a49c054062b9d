#include "lodeline/mapping/graph/motion/odometry_chain.h"

#include <fmt/format.h>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// Carries an error [dp, dtheta] in world axes by the lever arm v: dp + dtheta x v.
Mat6 carriedBy(const Vec3& v) {
  Mat6 carried = Mat6::Identity();
  carried.topRightCorner<3, 3>() = -so3::skew(v);
  return carried;
}

Mat6 turnedBy(const Quat& rotation) {
  Mat6 turned = Mat6::Zero();
  turned.topLeftCorner<3, 3>() = rotation.toRotationMatrix();
  turned.bottomRightCorner<3, 3>() = turned.topLeftCorner<3, 3>();
  return turned;
}

}  // namespace

void OdometryChain::start(KeyframeId id, const Rigid3& odom_from_body) {
  if (!poses_.empty()) throw InputError(fmt::format("keyframe {}: the chain of its dive has begun", id));
  checkPose(odom_from_body, "first keyframe of a chain");
  index_.emplace(id, 0);
  poses_.push_back(odom_from_body);
  covariance_.push_back(Mat6::Zero());
}

void OdometryChain::extend(KeyframeId id, const RelativePose& newest_from_next) {
  if (poses_.empty()) throw InputError(fmt::format("keyframe {}: the chain has no first keyframe", id));
  checkPose(newest_from_next.from_from_to, "odometry");
  checkCovariance(newest_from_next.covariance, "odometry");
  if (!index_.emplace(id, poses_.size()).second) {
    throw InputError(fmt::format("keyframe {}: the chain already has it", id));
  }
  const Rigid3 odom_from_next = poses_.back() * newest_from_next.from_from_to;
  const Mat6 to_origin = carriedBy(-odom_from_next.translation) * turnedBy(poses_.back().rotation);
  covariance_.push_back(covariance_.back() + to_origin * newest_from_next.covariance * to_origin.transpose());
  poses_.push_back(odom_from_next);
}

size_t OdometryChain::indexOf(KeyframeId id) const {
  const auto found = index_.find(id);
  if (found == index_.end()) throw InputError(fmt::format("keyframe {} is not in the chain", id));
  return found->second;
}

RelativePose OdometryChain::relative(KeyframeId from, KeyframeId to) const {
  const size_t i = indexOf(from), j = indexOf(to);
  if (i > j) return inverted(relative(to, from));
  const Mat6 to_axes = turnedBy(poses_[i].rotation.conjugate()) * carriedBy(poses_[j].translation);
  return {poses_[i].inverse() * poses_[j], to_axes * (covariance_[j] - covariance_[i]) * to_axes.transpose()};
}

}  // namespace lodeline
