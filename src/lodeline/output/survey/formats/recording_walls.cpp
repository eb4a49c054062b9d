#include "lodeline/output/survey/formats/recording_walls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace lodeline {
namespace {

/// The pose at a time between two poses: position linear, rotation by slerp.
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

}  // namespace

std::vector<Vec3> sonarWalls(MeasurementSource& source, const Trajectory& trajectory,
                             Diagnostics* diagnostics) {
  std::vector<Vec3> walls;
  if (!source.rig().sonar) return walls;
  int without_pose = 0;
  while (const std::optional<SonarSample> echo = source.nextSonar()) {
    if (!(echo->range_m > 0.0) || !std::isfinite(echo->angle_rad)) continue;
    const std::optional<Rigid3> world_from_body = poseAt(trajectory, echo->time);
    if (!world_from_body) {
      ++without_pose;
      continue;
    }
    const Vec3 echo_S = echo->range_m * Vec3(std::cos(echo->angle_rad), std::sin(echo->angle_rad), 0.0);
    walls.push_back(*world_from_body * (source.rig().sonar->body_from_sonar * echo_S));
  }
  if (without_pose > 0) {
    diagnostics->report(Severity::Notice, "sonar_without_pose",
                        fmt::format("sonar: {} echoes at times without a pose are left out", without_pose));
  }
  return walls;
}

}  // namespace lodeline
