#include "lodeline/evaluation/errors/run_errors.h"

#include <gtest/gtest.h>

#include "lodeline/evaluation/trajectory/test_trajectories.h"

namespace lodeline {
namespace {

Rigid3 yawTurn(double degrees) {
  return Rigid3(Quat(Eigen::AngleAxisd(degrees * M_PI / 180.0, Vec3::UnitZ())), Vec3(3.0, -2.0, 1.0));
}

RunErrors errorsOf(const Trajectory& estimate, const Trajectory& truth, HeadingBasis basis) {
  Diagnostics diagnostics;
  return computeRunErrors(estimate, truth, basis, {}, diagnostics);
}

/// 1 m per step eastwards; the heading error grows by `rate_deg_per_m` at every step, and the positions
/// follow it.
Trajectory bending(int count, double rate_deg_per_m) {
  Trajectory trajectory = test::straight(count);
  for (int i = 1; i < count; ++i) {
    const Quat turn(Eigen::AngleAxisd(rate_deg_per_m * i * M_PI / 180.0, Vec3::UnitZ()));
    trajectory.poses[i].world_from_body.rotation = turn;
    trajectory.poses[i].world_from_body.translation =
        trajectory.poses[i - 1].world_from_body.translation + turn * Vec3::UnitX();
  }
  return trajectory;
}

TEST(RunErrors, AWrongNorthIsAnErrorOnlyWhereNorthIsClaimed) {
  const Trajectory truth = test::bend(300);
  const Trajectory turned = test::transformed(truth, yawTurn(4.0));
  const RunErrors claimed = errorsOf(turned, truth, HeadingBasis::North);
  EXPECT_NEAR(claimed.heading_rmse_deg, 4.0, 1e-9);
  EXPECT_NEAR(claimed.heading_mean_deg, 4.0, 1e-9);
  EXPECT_NEAR(claimed.heading_max_deg, 4.0, 1e-9);
  const Vec3 way =
      truth.poses.back().world_from_body.translation - truth.poses.front().world_from_body.translation;
  const double off_m = 2.0 * std::sin(2.0 * M_PI / 180.0) * way.head<2>().norm();
  EXPECT_NEAR(claimed.end_point_percent, 100.0 * off_m / claimed.path_m, 1e-9);
  EXPECT_NEAR(claimed.end_point_equal_start_percent, 0.0, 1e-9);

  const RunErrors free = errorsOf(turned, truth, HeadingBasis::Start);
  EXPECT_NEAR(free.heading_rmse_deg, 0.0, 1e-9);
  EXPECT_NEAR(free.end_point_percent, 0.0, 1e-9);
  for (const RunErrors& errors : {claimed, free}) {
    EXPECT_NEAR(errors.sim3.rotation_deg, 0.0, 1e-6);
    EXPECT_NEAR(errors.yaw.position_m, 0.0, 1e-9);
    EXPECT_NEAR(errors.relativeYaw_deg(), 0.0, 1e-6);
  }
}

TEST(RunErrors, ScaleIsForgivenBySim3Alone) {
  const Trajectory truth = test::bend(300);
  const RunErrors errors =
      errorsOf(test::transformed(truth, yawTurn(70.0), 1.25), truth, HeadingBasis::Start);
  EXPECT_NEAR(errors.scale, 0.8, 1e-9);
  EXPECT_NEAR(errors.sim3.position_m, 0.0, 1e-9);
  EXPECT_GT(errors.yaw.position_m, 0.1);
  EXPECT_NEAR(errors.heading_rmse_deg, 0.0, 1e-9);
}

TEST(RunErrors, RelativeYawGrowsWithDriftAndNotWithAConstantError) {
  const Trajectory truth = test::straight(401);
  const RunErrors drifting = errorsOf(bending(401, 0.02), truth, HeadingBasis::Start);
  EXPECT_NEAR(drifting.relative_yaw_growth_deg, 2.0, 1e-6);
  EXPECT_NEAR(drifting.relativeYaw_deg(), 4.0, 1e-6);  // over half of the path
  EXPECT_NEAR(drifting.heading_max_deg, 8.0, 1e-6);
  const RunErrors constant = errorsOf(test::transformed(truth, yawTurn(4.0)), truth, HeadingBasis::North);
  EXPECT_NEAR(constant.relative_yaw_growth_deg, 0.0, 1e-9);
}

TEST(RunErrors, TracksBeginAtTheOrigin) {
  const Trajectory truth = test::transformed(test::bend(100), yawTurn(30.0));
  const RunErrors errors = errorsOf(test::bend(100), truth, HeadingBasis::Start);
  ASSERT_EQ(errors.estimate_track_m.size(), 100u);
  EXPECT_EQ(errors.reference_track_m.front(), Vec3::Zero());
  EXPECT_LT(errors.estimate_track_m.front().norm(), 1e-12);
  EXPECT_LT((errors.estimate_track_m.back() - errors.reference_track_m.back()).norm(), 1e-9);
}

}  // namespace
}  // namespace lodeline
