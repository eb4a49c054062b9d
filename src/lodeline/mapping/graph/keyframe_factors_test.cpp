#include "lodeline/mapping/graph/keyframe_factors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lodeline/mapping/graph/test_graphs.h"

namespace lodeline {
namespace {

TEST(AddKeyframe, AddsOdometryTiltHeadingAndDepth) {
  std::mt19937_64 generator(12);
  CircuitDive dive = swumCircuit({.keyframes = 40}, &generator);
  for (size_t k = 0; k < dive.keyframes.size(); ++k) {
    dive.keyframes[k].heading_sigma_rad = 0.01;
    dive.keyframes[k].depth_m = ScalarPrior{-dive.truth[k].translation.z(), 0.05};
  }
  PoseGraph graph = graphOf(dive);
  EXPECT_EQ(graph.size(), 40U);
  ASSERT_TRUE(graph.azimuthSigma(0).has_value());
  EXPECT_NEAR(*graph.azimuthSigma(0), std::sqrt(0.9) * 0.01, 1e-12);
  EXPECT_TRUE(graph.originDepthSigma(0).has_value());
  EXPECT_TRUE(graph.solve().converged);
  EXPECT_NEAR(graph.pose(39).translation.z(), dive.truth[39].translation.z(), 0.3);
  EXPECT_LT(std::sqrt(graph.covariance().of(39)(2, 2)), 0.15);
}

/// Two dives of one keyframe each, at depths of 30 and 31 m by a density known to 0.4 %.
PoseGraph twoDepths() {
  PoseGraph graph;
  for (const int dive : {0, 1}) {
    MapKeyframe keyframe;
    keyframe.id = dive;
    keyframe.dive = dive;
    keyframe.odom_from_body.translation.z() = 5.0 * dive;
    keyframe.depth_m = ScalarPrior{30.0 + dive, 0.12};
    addKeyframe(keyframe, nullptr, &graph);
  }
  return graph;
}

TEST(AddKeyframe, DepthsOfTwoDivesDifferByAirPressureAndDensity) {
  PoseGraph graph = twoDepths();
  EXPECT_TRUE(graph.solve().converged);
  EXPECT_NEAR(graph.pose(0).translation.z(), 0.0, 1e-6);
  EXPECT_NEAR(graph.pose(1).translation.z(), -1.0, 1e-3);
  EXPECT_NEAR(graph.surfaceHeight(), 30.0, 1e-3);
  // Each dive: 0.1 m of the air and the water level, 0.12 m of the density, 0.01 m of the height.
  const double variance = 0.1 * 0.1 + 0.12 * 0.12 + 0.01 * 0.01;
  EXPECT_NEAR(std::sqrt(graph.covariance().of(1)(2, 2)), std::sqrt(2.0 * variance), 1e-3);
}

TEST(AddKeyframe, AStatedHeightOfOneDiveIsThatOfTheOther) {
  PoseGraph graph = twoDepths();
  PositionMeasurement entrance;
  entrance.name = "entrance";
  entrance.node = 0;
  entrance.position_W = Vec3(0.0, 0.0, 412.0);
  entrance.covariance = 1e-4 * Mat3::Identity();
  graph.add(entrance);
  EXPECT_TRUE(graph.solve().converged);
  EXPECT_NEAR(graph.pose(0).translation.z(), 412.0, 1e-3);
  EXPECT_NEAR(graph.pose(1).translation.z(), 411.0, 1e-2);
  EXPECT_NEAR(graph.surfaceHeight(), 442.0, 1e-2);
}

TEST(AddKeyframe, AKnownSurfaceGivesADiveItsHeight) {
  PoseGraph graph = twoDepths();
  graph.add(SurfaceHeight{100.0, 0.05});
  EXPECT_TRUE(graph.solve().converged);
  EXPECT_NEAR(graph.pose(0).translation.z(), 70.0, 1e-3);
  EXPECT_NEAR(graph.pose(1).translation.z(), 69.0, 1e-3);
  const double variance = 0.1 * 0.1 + 0.12 * 0.12 + 0.01 * 0.01 + 0.05 * 0.05;
  EXPECT_NEAR(std::sqrt(graph.covariance().of(1)(2, 2)), std::sqrt(variance), 1e-3);
}

TEST(AddKeyframe, TheDepthOfADiveIsThatOfItsBestKeyframe) {
  PoseGraph graph;
  graph.add(SurfaceHeight{0.0, 0.01});
  MapKeyframe first;
  first.id = 0;
  first.depth_m = ScalarPrior{20.5, 0.4};  // by a wrong density
  addKeyframe(first, nullptr, &graph);
  MapKeyframe second = first;
  second.id = 1;
  second.odom_from_body.translation = Vec3(1.0, 0.0, -1.0);
  second.covariance = 1e-6 * Mat6::Identity();
  second.depth_m = ScalarPrior{21.0, 0.05};
  addKeyframe(second, &first, &graph);
  EXPECT_TRUE(graph.solve().converged);
  EXPECT_NEAR(graph.pose(0).translation.z(), -20.0, 0.01);
  EXPECT_NEAR(graph.pose(1).translation.z(), -21.0, 0.01);
}

/// Sigma of the azimuth of the last keyframe relative to the first one, rad.
double turnSigma(const PoseGraph& graph, const CircuitDive& dive) {
  const Mat6 covariance =
      graph.covariance().relative(dive.keyframes.front().id, dive.keyframes.back().id).covariance;
  const Vec3 up_B = dive.truth.front().rotation.conjugate() * Vec3::UnitZ();
  return std::sqrt(up_B.dot(covariance.bottomRightCorner<3, 3>() * up_B));
}

TEST(AddKeyframe, AHeadingThatIsOnlyCarriedOnAddsNothing) {
  std::mt19937_64 generator(13);
  CircuitDive dive = swumCircuit({.keyframes = 150}, &generator);
  PoseGraph without = graphOf(dive);
  without.solve();
  // North is known at the start; the gyroscope carries it on.
  for (MapKeyframe& keyframe : dive.keyframes)
    keyframe.heading_sigma_rad = std::hypot(0.01, std::sqrt(keyframe.covariance(5, 5)));
  PoseGraph with = graphOf(dive);
  with.solve();
  EXPECT_GT(turnSigma(without, dive), 0.03);
  EXPECT_NEAR(turnSigma(with, dive), turnSigma(without, dive), 0.05 * turnSigma(without, dive));
  EXPECT_NEAR(std::sqrt(with.covariance().of(149)(5, 5)), *dive.keyframes.back().heading_sigma_rad, 0.003);
}

TEST(AddKeyframe, AHeadingThatIsMeasuredAllTheTimeStaysKnownAsStated) {
  std::mt19937_64 generator(14);
  CircuitDive dive = swumCircuit({.keyframes = 150}, &generator);
  for (MapKeyframe& keyframe : dive.keyframes) keyframe.heading_sigma_rad = 0.02;
  PoseGraph graph = graphOf(dive);
  graph.solve();
  const double sigma = std::sqrt(graph.covariance().of(149)(5, 5));
  EXPECT_GT(sigma, 0.019);
  EXPECT_LT(sigma, 0.0205);
  EXPECT_LT(turnSigma(graph, dive), 0.02);
}

}  // namespace
}  // namespace lodeline
