#include "lodeline/trajectory.h"

#include <gtest/gtest.h>

#include <numbers>

#include "lodeline/evaluation/trajectory/test_trajectories.h"

namespace lodeline {
namespace {

constexpr double kRad = std::numbers::pi / 180.0;

std::vector<Rigid3> posesOf(const Trajectory& trajectory) {
  std::vector<Rigid3> poses;
  for (const StampedPose& pose : trajectory.poses) poses.push_back(pose.world_from_body);
  return poses;
}

TEST(Statistics, AreThoseOfAKnownSet) {
  const Statistics s = computeStatistics({4.0, 1.0, 3.0, 2.0});
  EXPECT_EQ(s.count, 4u);
  EXPECT_DOUBLE_EQ(s.mean, 2.5);
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(7.5));
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(s.min, 1.0);
  EXPECT_DOUBLE_EQ(s.lower_quartile, 1.75);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.upper_quartile, 3.25);
  EXPECT_DOUBLE_EQ(s.max, 4.0);
}

TEST(Statistics, OfNothingAndOfOneValue) {
  EXPECT_EQ(computeStatistics({}).count, 0u);
  EXPECT_EQ(computeStatistics({}).rmse, 0.0);
  EXPECT_DOUBLE_EQ(computeStatistics({2.0}).upper_quartile, 2.0);
}

TEST(AbsoluteErrors, SeparatePositionRotationAndYaw) {
  const Rigid3 reference(Quat(Eigen::AngleAxisd(1.0, Vec3::UnitX())), Vec3(1.0, 1.0, 1.0));
  const Quat yaw_error(Eigen::AngleAxisd(-3.0 * kRad, Vec3::UnitZ()));
  const Quat tilt_error(Eigen::AngleAxisd(4.0 * kRad, Vec3::UnitX()));
  const AbsoluteErrors errors =
      computeAbsoluteErrors({Rigid3(yaw_error * reference.rotation, Vec3(1.0, 4.0, 5.0)),
                             Rigid3(tilt_error * reference.rotation, reference.translation)},
                            {reference, reference});
  EXPECT_DOUBLE_EQ(errors.position().max, 5.0);
  EXPECT_NEAR(errors.rotation_deg[0], 3.0, 1e-9);
  EXPECT_NEAR(errors.yaw_deg[0], -3.0, 1e-9);
  EXPECT_NEAR(errors.rotation_deg[1], 4.0, 1e-9);
  EXPECT_NEAR(errors.yaw_deg[1], 0.0, 1e-9);
}

TEST(Stretches, OverlappingOnesTakeTheClosestEnd) {
  const auto stretches = overlappingStretches({0.0, 0.9, 1.3, 2.0, 2.05}, 1.0, 0.2);
  ASSERT_EQ(stretches.size(), 2u);  // from 0.9 the closest are 2.0 and 1.3, with errors of 0.1 and 0.6
  EXPECT_EQ(stretches[0].start, 0u);
  EXPECT_EQ(stretches[0].end, 1u);
  EXPECT_EQ(stretches[1].start, 1u);
  EXPECT_EQ(stretches[1].end, 3u);
}

TEST(Stretches, OverlappingOnesNeedPathLeft) {
  EXPECT_TRUE(overlappingStretches({0.0, 0.9}, 1.0, 0.2).empty());
  EXPECT_TRUE(overlappingStretches({}, 1.0, 0.2).empty());
  EXPECT_TRUE(overlappingStretches({0.0, 0.0, 0.0}, 1.0, 0.2).empty());
}

TEST(Stretches, ConsecutiveOnesShareTheirEnds) {
  const auto stretches = consecutiveStretches({0.0, 0.6, 1.2, 1.8, 2.3, 3.0, 3.4}, 1.0);
  ASSERT_EQ(stretches.size(), 2u);
  EXPECT_EQ(stretches[0].start, 2u);
  EXPECT_EQ(stretches[0].end, 4u);
  EXPECT_EQ(stretches[1].start, 4u);
  EXPECT_EQ(stretches[1].end, 6u);
}

TEST(RelativeErrors, OfAWrongScaleAreTheSameShareOfEveryStretch) {
  const Trajectory truth = test::straight(101);
  Diagnostics diagnostics;
  EvaluationOptions options;
  options.alignment = AlignmentType::None;
  const Evaluation e = evaluate(test::transformed(truth, Rigid3(), 1.02), truth, options, diagnostics);
  ASSERT_EQ(e.relative.size(), 5u);
  for (const RelativeErrors& r : e.relative) {
    EXPECT_EQ(r.size(), 101u - static_cast<std::size_t>(r.length_m));
    for (const double percent : r.translation_percent) EXPECT_NEAR(percent, 2.0, 1e-9);
    for (const double angle_deg : r.rotation_deg) EXPECT_NEAR(angle_deg, 0.0, 1e-9);
  }
  EXPECT_NEAR(e.end_point_m, 2.0, 1e-9);
  EXPECT_NEAR(e.percentOfPath(e.end_point_m), 2.0, 1e-9);
}

/// A heading drift of `rate_deg_per_m` bends a straight path into an arc of radius 1 / rate.
Trajectory driftedStraight(int count, double rate_deg_per_m) {
  Trajectory trajectory = test::straight(count);
  const double rate = rate_deg_per_m * kRad;
  for (StampedPose& pose : trajectory.poses) {
    const double s = pose.world_from_body.translation.x();
    pose.world_from_body = Rigid3(Quat(Eigen::AngleAxisd(rate * s, Vec3::UnitZ())),
                                  Vec3(std::sin(rate * s) / rate, (1.0 - std::cos(rate * s)) / rate, 0.0));
  }
  return trajectory;
}

TEST(RelativeErrors, OfADriftingHeadingGrowWithTheLength) {
  const double rate_deg_per_m = 0.05;
  const Trajectory truth = test::straight(201);
  const Trajectory estimate = driftedStraight(201, rate_deg_per_m);
  const auto reference = posesOf(truth);
  for (const double length_m : {10.0, 40.0, 100.0}) {
    const auto stretches = overlappingStretches(distancesFromStart(reference), length_m, 0.1);
    const RelativeErrors r = computeRelativeErrors(posesOf(estimate), reference, stretches, length_m);
    const double turn = rate_deg_per_m * length_m * kRad;
    const double radius_m = 1.0 / (rate_deg_per_m * kRad);
    const double expected_m =
        std::hypot(std::sin(turn) * radius_m - length_m, (1.0 - std::cos(turn)) * radius_m);
    ASSERT_EQ(r.size(), 201u - static_cast<std::size_t>(length_m));
    for (std::size_t i = 0; i < r.size(); ++i) {
      EXPECT_NEAR(r.yaw_deg[i], rate_deg_per_m * length_m, 1e-9);
      EXPECT_NEAR(r.rotation_deg[i], rate_deg_per_m * length_m, 1e-9);
      EXPECT_NEAR(r.rotation_deg_per_m[i], rate_deg_per_m, 1e-9);
      EXPECT_NEAR(r.translation_m[i], expected_m, 1e-9);
    }
  }
}

TEST(RelativeErrors, ReadYawInTheWorldAndNotInATiltedBody) {
  // The body looks along its x axis; a rotation about the world's vertical is one about the body's y axis.
  const Quat tilted(Eigen::AngleAxisd(90.0 * kRad, Vec3::UnitX()));
  const Quat turned = Quat(Eigen::AngleAxisd(2.0 * kRad, Vec3::UnitZ())) * tilted;
  const std::vector<Rigid3> reference = {Rigid3(tilted, Vec3::Zero()), Rigid3(tilted, Vec3::UnitX())};
  const std::vector<Rigid3> estimate = {Rigid3(tilted, Vec3::Zero()), Rigid3(turned, Vec3::UnitX())};
  const RelativeErrors r = computeRelativeErrors(estimate, reference, {{0, 1}}, 1.0);
  EXPECT_NEAR(r.yaw_deg[0], 2.0, 1e-9);
}

TEST(RelativeErrors, DoNotDependOnTheWorlds) {
  const Trajectory truth = test::bend(100);
  const Rigid3 transform(Quat(Eigen::AngleAxisd(1.3, Vec3(1.0, 2.0, -1.0).normalized())),
                         Vec3(5.0, 6.0, 7.0));
  Diagnostics diagnostics;
  const Evaluation e = evaluate(test::transformed(truth, transform), truth, {}, diagnostics);
  ASSERT_FALSE(e.relative.empty());
  for (const RelativeErrors& r : e.relative) {
    EXPECT_LT(computeStatistics(r.translation_m).max, 1e-9);
    EXPECT_LT(computeStatistics(r.rotation_deg).max, 1e-6);
  }
  EXPECT_LT(e.drift_m, 1e-9);
}

TEST(Evaluation, OfTrajectoriesThatDoNotMoveHasNoRelativeErrors) {
  Trajectory still = test::straight(30);
  for (StampedPose& pose : still.poses) pose.world_from_body.translation.setZero();
  Diagnostics diagnostics;
  const Evaluation e = evaluate(still, still, {}, diagnostics);
  EXPECT_TRUE(e.relative.empty());
  EXPECT_EQ(e.consecutive.size(), 0u);
  EXPECT_EQ(e.percentOfPath(1.0), 0.0);
  EXPECT_EQ(diagnostics.count("alignment_degenerate"), 1);
}

TEST(Evaluation, AlignsOnTheFirstPairsOnlyWhenAsked) {
  EvaluationOptions options;
  options.alignment = AlignmentType::Yaw;
  Diagnostics diagnostics;
  const Evaluation whole = evaluate(driftedStraight(101, 0.1), test::straight(101), options, diagnostics);
  options.alignment_pairs = 5;
  const Evaluation start = evaluate(driftedStraight(101, 0.1), test::straight(101), options, diagnostics);
  EXPECT_GT(start.end_point_m, 3.0 * whole.end_point_m);
  EXPECT_LT(start.absolute.position_m.front().norm(), 0.01);
}

TEST(Evaluation, TurnsCameraWorldsUpright) {
  Trajectory truth = test::straight(50);
  truth.up = WorldUp::MinusY;
  Trajectory estimate = truth;
  for (StampedPose& pose : estimate.poses) {
    pose.world_from_body.rotation = Quat(Eigen::AngleAxisd(-0.02, Vec3::UnitY()));
  }
  EvaluationOptions options;
  options.alignment = AlignmentType::None;
  Diagnostics diagnostics;
  const Evaluation e = evaluate(estimate, truth, options, diagnostics);
  EXPECT_NEAR(e.absolute.yaw_deg.front(), 0.02 / kRad, 1e-9);
}

}  // namespace
}  // namespace lodeline
