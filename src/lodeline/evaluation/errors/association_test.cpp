#include "lodeline/trajectory.h"

#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

namespace lodeline {
namespace {

/// Poses whose x is their time, so that a pair shows which poses were associated.
Trajectory atTimes(const std::vector<double>& times_s) {
  Trajectory trajectory;
  trajectory.name = "times";
  for (const double t : times_s) {
    trajectory.poses.push_back({Time::fromSeconds(t), Rigid3(Quat::Identity(), Vec3(t, 0, 0))});
  }
  return trajectory;
}

TEST(Association, TakesTheNearestWithinTheTolerance) {
  const Trajectory estimate = atTimes({1.000, 1.104, 1.205});
  const Trajectory reference = atTimes({0.9, 0.995, 1.003, 1.1, 1.192, 1.219});
  const PosePairs pairs = associate(estimate, reference, {});
  ASSERT_EQ(pairs.size(), 2u);  // 1.205 is 13 and 14 ms away from its neighbours
  EXPECT_EQ(pairs.reference[0].translation.x(), 1.003);
  EXPECT_EQ(pairs.reference[1].translation.x(), 1.1);
  EXPECT_EQ(pairs.time[1], Time::fromSeconds(1.1));
}

TEST(Association, AcceptsExactlyTheTolerance) {
  const Trajectory reference = atTimes({1.01, 5.0});
  EXPECT_EQ(associate(atTimes({1.0}), reference, {}).size(), 1u);
  EXPECT_THROW(associate(atTimes({0.999999999}), reference, {}), InputError);
}

TEST(Association, AddsTheOffsetToTheEstimate) {
  const PosePairs pairs =
      associate(atTimes({1.0, 2.0}), atTimes({3.5, 4.5, 5.5}), {AssociationMethod::Nearest, 0.01, 2.5});
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs.estimate[0].translation.x(), 1.0);
  EXPECT_EQ(pairs.reference[0].translation.x(), 3.5);
}

TEST(Association, UsesEachPoseOnceAndKeepsTheCloser) {
  const PosePairs pairs = associate(atTimes({1.000, 1.004}), atTimes({0.5, 1.003, 2.0}), {});
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs.estimate[0].translation.x(), 1.004);
}

TEST(Association, DenseEstimateMeetsEachReferencePoseOnce) {
  const PosePairs pairs = associate(atTimes({0.99, 0.995, 1.0, 1.005, 1.01}), atTimes({1.001}), {});
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs.estimate[0].translation.x(), 1.0);
}

TEST(Association, InterpolatesTheReference) {
  Trajectory reference = atTimes({1.0, 1.01});
  reference.poses[1].world_from_body.rotation = Quat(Eigen::AngleAxisd(0.4, Vec3::UnitZ()));
  const PosePairs pairs =
      associate(atTimes({0.999, 1.0, 1.0025, 1.02}), reference, {AssociationMethod::Interpolate, 0.01, 0.0});
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs.reference[0].translation.x(), 1.0);
  EXPECT_NEAR(pairs.reference[1].translation.x(), 1.0025, 1e-12);
  EXPECT_NEAR(Eigen::AngleAxisd(pairs.reference[1].rotation).angle(), 0.1, 1e-9);
}

TEST(Association, DoesNotInterpolateAcrossAGapOfTheReference) {
  EXPECT_THROW(associate(atTimes({1.5}), atTimes({1.0, 2.0}), {AssociationMethod::Interpolate, 0.01, 0.0}),
               InputError);
}

TEST(Association, RowsPairByIndexWhateverTheTolerance) {
  Trajectory estimate = test::straight(5);
  Trajectory reference = test::straight(7);
  estimate.time_base = reference.time_base = TimeBase::Index;
  EXPECT_EQ(associate(estimate, reference, {AssociationMethod::Nearest, 10.0, 0.0}).size(), 5u);
}

TEST(Association, RefusesRowsAgainstTimes) {
  Trajectory rows = test::straight(5);
  rows.time_base = TimeBase::Index;
  EXPECT_THROW(associate(rows, test::straight(5), {}), InputError);
}

TEST(Association, NamesBothSpansWhenNothingMatches) {
  try {
    associate(atTimes({1.0, 2.0}), atTimes({101.0, 102.0}), {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("101.000"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("--time-offset-s"), std::string::npos);
  }
}

TEST(SortByTime, OrdersReportsAndKeepsTheFirstOfEqualTimes) {
  Trajectory trajectory = atTimes({1.0, 3.0, 2.0, 3.0});
  trajectory.poses[3].world_from_body.translation.y() = 9.0;
  Diagnostics diagnostics;
  sortByTime(trajectory, diagnostics);
  ASSERT_EQ(trajectory.size(), 3u);
  EXPECT_EQ(trajectory.poses[1].world_from_body.translation.x(), 2.0);
  EXPECT_EQ(trajectory.poses[2].world_from_body.translation.y(), 0.0);
  EXPECT_EQ(diagnostics.count("trajectory_disorder"), 1);
  EXPECT_EQ(diagnostics.count("trajectory_duplicate"), 1);
}

TEST(Completion, CountsImagesWithAPose) {
  const std::vector<Time> images = {Time::fromSeconds(1.0), Time::fromSeconds(1.1), Time::fromSeconds(1.2),
                                    Time::fromSeconds(1.3)};
  const Completion completion =
      completionByImages(atTimes({1.1, 1.2, 1.25}), images, Duration(), Duration::fromSeconds(0.01));
  EXPECT_EQ(completion.expected, 4u);
  EXPECT_EQ(completion.estimated, 2u);
  EXPECT_DOUBLE_EQ(completion.share, 0.5);
}

TEST(Completion, TakesTheTimeOffsetOfTheEstimateIntoAccount) {
  const Completion completion = completionByImages(atTimes({0.6}), {Time::fromSeconds(1.1)},
                                                   Duration::fromSeconds(0.5), Duration::fromSeconds(0.01));
  EXPECT_EQ(completion.estimated, 1u);
}

TEST(Completion, CoversTimeExceptGapsAndWhatLiesOutside) {
  std::vector<double> times_s;
  for (int i = 0; i <= 40; ++i) times_s.push_back(-1.0 + 0.1 * i);  // -1 s to 3 s
  for (int i = 0; i <= 20; ++i) times_s.push_back(7.0 + 0.1 * i);   // 7 s to 9 s
  const Completion completion = completionByTime(atTimes(times_s), atTimes({0.0, 10.0}), Duration());
  EXPECT_NEAR(completion.share, 0.5, 1e-9);
}

TEST(Completion, DoesNotBlameKeyframesForTheirSparsity) {
  const Completion completion =
      completionByTime(atTimes({0.0, 2.0, 4.0, 6.0, 8.0, 10.0}), atTimes({0.0, 10.0}), Duration());
  EXPECT_DOUBLE_EQ(completion.share, 1.0);
}

}  // namespace
}  // namespace lodeline
