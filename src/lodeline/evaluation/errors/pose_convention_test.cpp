#include "lodeline/evaluation/errors/pose_convention.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

using ::testing::HasSubstr;

/// A path of some metres with turns about all axes. The estimate has another world and 1 mm of noise.
PosePairs pairsOfPath() {
  const Rigid3 world(Quat(Eigen::AngleAxisd(0.7, Vec3(0.2, 0.3, 0.9).normalized())), Vec3(4.0, -2.0, 1.0));
  PosePairs pairs;
  for (int i = 0; i < 80; ++i) {
    const double t = 0.1 * i;
    const Rigid3 pose(
        Quat(Eigen::AngleAxisd(t, Vec3::UnitZ())) * Quat(Eigen::AngleAxisd(0.5 * std::sin(t), Vec3::UnitX())),
        Vec3(3.0 * std::cos(t), 2.0 * std::sin(1.3 * t), 0.3 * t));
    pairs.time.push_back(Time::fromSeconds(t));
    pairs.reference.push_back(pose);
    pairs.estimate.push_back(world * pose);
    pairs.estimate.back().translation += 1e-3 * Vec3(std::sin(9.0 * i), std::sin(8.0 * i), std::sin(7.0 * i));
  }
  return pairs;
}

std::string findingOf(const PosePairs& pairs, const char* kind, AlignmentType type = AlignmentType::SE3) {
  Diagnostics diagnostics;
  const bool are_inverted = checkPoseConvention(pairs, type, diagnostics);
  EXPECT_EQ(are_inverted, diagnostics.count("poses_inverted") > 0);
  return diagnostics.count(kind) == 1 && diagnostics.ranked().size() == 1
             ? diagnostics.ranked().front().first_message
             : "";
}

void expectNone(const PosePairs& pairs, AlignmentType type = AlignmentType::SE3) {
  Diagnostics diagnostics;
  EXPECT_FALSE(checkPoseConvention(pairs, type, diagnostics));
  EXPECT_TRUE(diagnostics.ranked().empty());
}

TEST(PoseConvention, OfGoodAndOfBadEstimatesIsNoFinding) {
  expectNone(pairsOfPath());
  PosePairs bad = pairsOfPath();
  for (std::size_t i = 0; i < bad.size(); ++i) bad.estimate[i] = bad.estimate[(i * 37) % bad.size()];
  expectNone(bad);
  PosePairs still = pairsOfPath();
  for (Rigid3& pose : still.estimate) pose = Rigid3();
  expectNone(still);
}

TEST(PoseConvention, NamesInvertedPoses) {
  PosePairs pairs = pairsOfPath();
  for (Rigid3& pose : pairs.estimate) pose = pose.inverse();
  EXPECT_THAT(findingOf(pairs, "poses_inverted"), HasSubstr("poses of the estimate inverted"));
  std::swap(pairs.estimate, pairs.reference);
  EXPECT_THAT(findingOf(pairs, "poses_inverted"), HasSubstr("poses of the reference inverted"));
}

TEST(PoseConvention, NamesTheUnitOfPositions) {
  const auto scaledBy = [](double factor) {
    PosePairs pairs = pairsOfPath();
    for (Rigid3& pose : pairs.estimate) pose.translation *= factor;
    return pairs;
  };
  EXPECT_THAT(findingOf(scaledBy(1000.0), "position_scale"),
              HasSubstr("estimate seems to be in millimetres"));
  EXPECT_THAT(findingOf(scaledBy(1.0 / 0.3048), "position_scale"), HasSubstr("estimate seems to be in feet"));
  EXPECT_THAT(findingOf(scaledBy(0.01), "position_scale"), HasSubstr("reference seems to be in centimetres"));
  EXPECT_THAT(findingOf(scaledBy(2.2), "position_scale"), HasSubstr("--align sim3"));
  expectNone(scaledBy(1.1));  // drift of scale
  expectNone(scaledBy(2.2), AlignmentType::Sim3);
}

Trajectory startingAt(double time_s) {
  Trajectory trajectory;
  trajectory.name = "poses.txt";
  for (int i = 0; i < 100; ++i) trajectory.poses.push_back({Time::fromSeconds(time_s + 0.1 * i), Rigid3()});
  return trajectory;
}

TEST(DifferenceOfClocks, IsNamedWhereItIsAUsualOne) {
  const Trajectory reference = startingAt(1'700'000'000.0);
  EXPECT_THAT(differenceOfClocks(startingAt(1'700'007'203.0), reference),
              HasSubstr("two time zones, 2 h apart?; try --time-offset-s -7200"));
  EXPECT_THAT(differenceOfClocks(startingAt(1'699'999'998.0 - 19800.0), reference),
              HasSubstr("5.5 h apart?; try --time-offset-s 19800"));
  EXPECT_THAT(differenceOfClocks(startingAt(1'384'035'218.0), reference),
              HasSubstr("GPS time and Unix time?; try --time-offset-s 315964782"));
  EXPECT_THAT(differenceOfClocks(startingAt(12.0), reference),
              HasSubstr("counts from its start?; try --time-offset-s 1699999988"));
  EXPECT_THAT(differenceOfClocks(startingAt(1'700'086'000.0), reference), HasSubstr("check the clocks"));
}

}  // namespace
}  // namespace lodeline
