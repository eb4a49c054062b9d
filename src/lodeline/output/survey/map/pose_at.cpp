#include "lodeline/output/survey/map/pose_at.h"

#include <algorithm>

namespace lodeline {

std::optional<Rigid3> poseAt(const Trajectory& trajectory, Time time) {
  constexpr double kMaxGap_s = 0.2;
  const auto after = std::lower_bound(trajectory.poses.begin(), trajectory.poses.end(), time,
                                      [](const StampedPose& pose, Time t) { return pose.time < t; });
  if (after == trajectory.poses.end()) return std::nullopt;
  if (after->time == time) return after->world_from_body;
  if (after == trajectory.poses.begin()) return std::nullopt;
  const StampedPose& before = *(after - 1);
  const double left_s = (time - before.time).seconds(), right_s = (after->time - time).seconds();
  if (left_s > kMaxGap_s || right_s > kMaxGap_s) return std::nullopt;
  const double share = left_s / (left_s + right_s);
  const Rigid3 &a = before.world_from_body, &b = after->world_from_body;
  return Rigid3(a.rotation.slerp(share, b.rotation), a.translation + share * (b.translation - a.translation));
}

}  // namespace lodeline
