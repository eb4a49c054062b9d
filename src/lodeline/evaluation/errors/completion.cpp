#include "lodeline/trajectory.h"

#include <algorithm>

namespace lodeline {
namespace {

bool hasPoseNear(const std::vector<StampedPose>& poses, Time time, Duration tolerance) {
  const auto first = std::lower_bound(poses.begin(), poses.end(), time - tolerance,
                                      [](const StampedPose& pose, Time t) { return pose.time < t; });
  return first != poses.end() && first->time <= time + tolerance;
}

}  // namespace

Completion completionByImages(const Trajectory& estimate, const std::vector<Time>& image_stamps,
                              Duration time_offset, Duration tolerance) {
  Completion result;
  result.by_images = true;
  result.expected = image_stamps.size();
  for (const Time stamp : image_stamps) {
    if (hasPoseNear(estimate.poses, stamp - time_offset, tolerance)) ++result.estimated;
  }
  if (result.expected > 0) {
    result.share = static_cast<double>(result.estimated) / static_cast<double>(result.expected);
  }
  return result;
}

Completion completionByTime(const Trajectory& estimate, const Trajectory& reference, Duration time_offset) {
  Completion result;
  if (estimate.empty() || reference.empty()) return result;
  const Time begin = reference.poses.front().time;
  const Time end = reference.poses.back().time;
  const Duration interval = medianInterval(estimate);
  const Duration longest_gap = std::max(Duration::fromSeconds(1.0), interval + interval + interval);
  Duration covered;
  for (std::size_t i = 1; i < estimate.size(); ++i) {
    if (estimate.poses[i].time - estimate.poses[i - 1].time > longest_gap) continue;
    const Time from = std::clamp(estimate.poses[i - 1].time + time_offset, begin, end);
    const Time to = std::clamp(estimate.poses[i].time + time_offset, begin, end);
    covered = covered + (to - from);
  }
  if (end > begin) result.share = covered.seconds() / (end - begin).seconds();
  return result;
}

}  // namespace lodeline
