#include "lodeline/trajectory.h"
#include "lodeline/util/median.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

bool earlier(const StampedPose& a, const StampedPose& b) { return a.time < b.time; }

}  // namespace

void sortByTime(Trajectory& trajectory, Diagnostics& diagnostics) {
  auto& poses = trajectory.poses;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (!earlier(poses[i], poses[i - 1])) continue;
    diagnostics.report(
        Severity::Warning, "trajectory_disorder",
        fmt::format("{}: time goes back from {:.9f} s to {:.9f} s; the poses were put in order",
                    trajectory.name, poses[i - 1].time.seconds(), poses[i].time.seconds()));
  }
  std::stable_sort(poses.begin(), poses.end(), earlier);

  std::vector<StampedPose> unique;
  unique.reserve(poses.size());
  for (const StampedPose& pose : poses) {
    if (!unique.empty() && unique.back().time == pose.time) {
      diagnostics.report(Severity::Warning, "trajectory_duplicate",
                         fmt::format("{}: several poses at {:.9f} s; the first was kept", trajectory.name,
                                     pose.time.seconds()));
      continue;
    }
    unique.push_back(pose);
  }
  poses = std::move(unique);
}

Trajectory withZUp(Trajectory trajectory) {
  if (trajectory.up == WorldUp::Z) return trajectory;
  // x right, y down, z forward becomes x right, y forward, z up.
  const Rigid3 up_from_world(Quat(Eigen::AngleAxisd(-M_PI / 2, Vec3::UnitX())), Vec3::Zero());
  for (StampedPose& pose : trajectory.poses) pose.world_from_body = up_from_world * pose.world_from_body;
  trajectory.up = WorldUp::Z;
  return trajectory;
}

std::vector<double> distancesFromStart(const std::vector<Rigid3>& world_from_body) {
  std::vector<double> distances_m(world_from_body.size(), 0.0);
  for (std::size_t i = 1; i < world_from_body.size(); ++i) {
    const Vec3 step_m = world_from_body[i].translation - world_from_body[i - 1].translation;
    distances_m[i] = distances_m[i - 1] + step_m.norm();
  }
  return distances_m;
}

double pathLength(const Trajectory& trajectory) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    length_m += (trajectory.poses[i].world_from_body.translation -
                 trajectory.poses[i - 1].world_from_body.translation)
                    .norm();
  }
  return length_m;
}

Duration medianInterval(const Trajectory& trajectory) {
  if (trajectory.size() < 2) return Duration();
  std::vector<int64_t> intervals_ns;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    intervals_ns.push_back((trajectory.poses[i].time - trajectory.poses[i - 1].time).nanoseconds());
  }
  return Duration::fromNanoseconds(median(std::move(intervals_ns)));
}

}  // namespace lodeline
