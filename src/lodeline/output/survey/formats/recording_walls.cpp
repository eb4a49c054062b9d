#include "lodeline/output/survey/formats/recording_walls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "lodeline/output/survey/map/pose_at.h"

namespace lodeline {
namespace {

/// Place of a time between the first pose and the last, 0 to 1.
double shareAt(const Trajectory& trajectory, Time time) {
  if (trajectory.poses.size() < 2) return 0.0;
  const Time begin = trajectory.poses.front().time;
  const double length_s = (trajectory.poses.back().time - begin).seconds();
  return length_s > 0.0 ? std::clamp((time - begin).seconds() / length_s, 0.0, 1.0) : 0.0;
}

}  // namespace

std::vector<Vec3> sonarWalls(MeasurementSource& source, const Trajectory& trajectory,
                             Diagnostics* diagnostics, const ShareDone& progress) {
  std::vector<Vec3> walls;
  if (!source.rig().sonar) return walls;
  int without_pose = 0;
  while (const std::optional<SonarSample> echo = source.nextSonar()) {
    progress(shareAt(trajectory, echo->time));
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
