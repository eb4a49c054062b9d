#include "lodeline/output/survey/map/carried_trajectory.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

/// A body on an arc, at 10 Hz.
Rigid3 bodyAt(double time_s) {
  const Quat turn(Eigen::AngleAxisd(0.1 * time_s, Vec3::UnitZ()));
  return {turn, Vec3(4.0 * std::sin(0.1 * time_s), 4.0 - 4.0 * std::cos(0.1 * time_s), -0.05 * time_s)};
}

Trajectory arc(double step_s, double begin_s, double end_s, const Rigid3& world_from_arc = {}) {
  Trajectory trajectory;
  for (int i = 0; begin_s + i * step_s <= end_s + 1e-9; ++i) {
    const double time_s = begin_s + i * step_s;
    trajectory.poses.push_back({Time::fromSeconds(time_s), world_from_arc * bodyAt(time_s)});
  }
  return trajectory;
}

const Rigid3 kOdometry(Quat(Eigen::AngleAxisd(1.2, Vec3::UnitZ())), Vec3(7.0, -3.0, 1.0));

TEST(CarriedTrajectory, IsThatOfTheSolutionBetweenItsPoses) {
  const Trajectory carried = carriedTrajectory(arc(0.1, 0.0, 20.0, kOdometry), arc(1.5, 0.0, 18.0));
  ASSERT_EQ(carried.size(), 201u);
  for (const StampedPose& pose : carried.poses) {
    const Rigid3 expected = bodyAt(pose.time.seconds());
    EXPECT_LT((pose.world_from_body.translation - expected.translation).norm(), 1e-9);
    EXPECT_LT(pose.world_from_body.rotation.angularDistance(expected.rotation), 1e-9);
  }
}

// Where odometry drifts, every part is at its own pose of the solution.
TEST(CarriedTrajectory, FollowsTheSolutionAndNotTheDrift) {
  Trajectory drifting = arc(0.1, 0.0, 60.0);
  for (StampedPose& pose : drifting.poses) pose.world_from_body.translation.x() += 0.02 * pose.time.seconds();
  const Trajectory carried = carriedTrajectory(drifting, arc(1.0, 0.0, 60.0));
  for (const StampedPose& pose : carried.poses) {
    const Vec3 error = pose.world_from_body.translation - bodyAt(pose.time.seconds()).translation;
    EXPECT_LT(error.norm(), 0.011);
  }
}

TEST(CarriedTrajectory, LeavesOutWhatTheSolutionDoesNotReach) {
  const Trajectory odometry = arc(0.1, 0.0, 20.0);
  EXPECT_EQ(carriedTrajectory(odometry, arc(1.0, 5.0, 10.0)).poses.front().time, Time::fromSeconds(2.0));
  EXPECT_TRUE(carriedTrajectory(odometry, {}).empty());
  EXPECT_TRUE(carriedTrajectory({}, arc(1.0, 5.0, 10.0)).empty());
  EXPECT_TRUE(carriedTrajectory(odometry, arc(1.0, 100.0, 110.0)).empty());
}

}  // namespace
}  // namespace lodeline
