#include "lodeline/output/survey/map/carried_trajectory.h"

#include <cmath>

#include "lodeline/output/survey/map/pose_at.h"

namespace lodeline {
namespace {

/// Motion from the odometry's world to that of the solution, at one time.
struct WorldShift {
  Time time;
  Rigid3 solved_from_odometry;
};

std::vector<WorldShift> shiftsOf(const Trajectory& odometry, const Trajectory& solved) {
  std::vector<WorldShift> shifts;
  for (const StampedPose& pose : solved.poses) {
    const std::optional<Rigid3> at = poseAt(odometry, pose.time);
    if (at) shifts.push_back({pose.time, pose.world_from_body * at->inverse()});
  }
  return shifts;
}

}  // namespace

Trajectory carriedTrajectory(const Trajectory& odometry, const Trajectory& solved, double longest_s) {
  Trajectory carried;
  carried.name = odometry.name;
  const std::vector<WorldShift> shifts = shiftsOf(odometry, solved);
  size_t nearest = 0;
  const auto away_s = [&](size_t i, Time time) { return std::abs((shifts[i].time - time).seconds()); };
  for (const StampedPose& pose : odometry.poses) {
    if (shifts.empty()) break;
    while (nearest + 1 < shifts.size() && away_s(nearest + 1, pose.time) <= away_s(nearest, pose.time))
      ++nearest;
    if (away_s(nearest, pose.time) > longest_s) continue;
    carried.poses.push_back({pose.time, shifts[nearest].solved_from_odometry * pose.world_from_body});
  }
  return carried;
}

}  // namespace lodeline
