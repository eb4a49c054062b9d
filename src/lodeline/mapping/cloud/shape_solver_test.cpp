#include "lodeline/mapping/cloud/shape_solver.h"

#include <gtest/gtest.h>

#include "lodeline/mapping/cloud/mirrored_cloud.h"
#include "lodeline/mapping/cloud/trials/test_cloud_pairs.h"

namespace lodeline {
namespace {

LocalCloud tubeCloud() {
  std::mt19937_64 random(2);
  const test::TubeWorld world(test::Tube{});
  return test::cloudAt(world, 20.0, false, {}, random).cloud;
}

ShapePrior priorOf(double horizontal_m) {
  ShapePrior prior;
  // The body's y axis is vertical.
  prior.covariance =
      Vec4(squared(horizontal_m), squared(0.05), squared(horizontal_m), squared(0.03)).asDiagonal();
  return prior;
}

TEST(ShapeSolver, FallsFromOneWithTheError) {
  EXPECT_EQ(shapeWeight(0.0, 3.0), 1.0);
  EXPECT_NEAR(shapeWeight(3.0, 3.0), 0.25, 1e-12);
  EXPECT_LT(shapeWeight(30.0, 3.0), 1e-3);
}

TEST(ShapeSolver, CoversThePriorWithStarts) {
  const LocalCloud cloud = tubeCloud();
  const ShapeProblem problem(cloud, cloud, 10);
  EXPECT_EQ(startsOf(problem, priorOf(0.05), 0.6, 81).size(), 1u);
  const auto starts = startsOf(problem, priorOf(0.6), 0.6, 81);
  EXPECT_EQ(starts.size(), 25u);
  double farthest = 0.0;
  for (const ShapeState& start : starts)
    farthest = std::max(farthest, problem.difference({}, start.old_from_new).head<3>().norm());
  EXPECT_GT(farthest, 1.5);
  EXPECT_TRUE(startsOf(problem, priorOf(5.0), 0.6, 81).empty());
}

TEST(ShapeSolver, MovesStartsAlongTheCorrelation) {
  const LocalCloud cloud = tubeCloud();
  const ShapeProblem problem(cloud, cloud, 10);
  ShapePrior prior = priorOf(0.6);
  prior.covariance(0, 3) = prior.covariance(3, 0) = 0.9 * 0.6 * 0.03;
  for (const ShapeState& start : startsOf(problem, prior, 0.6, 81)) {
    const Vec4 moved = problem.difference({}, start.old_from_new);
    EXPECT_NEAR(moved[3], 0.9 * 0.03 / 0.6 * moved[0], 1e-6);
  }
}

TEST(ShapeSolver, ReturnsToTheTruth) {
  const LocalCloud cloud = tubeCloud();
  const ShapeProblem problem(cloud, cloud, 10);
  Vec5 away;
  away << 0.2, 0.05, -0.25, 0.03, 0.0;
  const ShapeFit fit = fitShape(problem, priorOf(1.0), problem.moved({}, away), 0.5, 1, 40);
  EXPECT_TRUE(fit.converged);
  EXPECT_LT(problem.difference({}, fit.state.old_from_new).norm(), 0.02);
  EXPECT_GT(fit.counterpart_share, 0.7);
}

TEST(ShapeSolver, SaysWhereNothingFits) {
  const LocalCloud cloud = tubeCloud();
  const LocalCloud empty;
  const ShapeProblem problem(cloud, empty, 10);
  const ShapeFit fit = fitShape(problem, priorOf(1.0), {}, 0.5, 1, 40);
  EXPECT_FALSE(fit.converged);
  EXPECT_GE(fit.score, 1e9);
  EXPECT_TRUE(minimaOf(problem, priorOf(1.0), {{}}).empty());
}

TEST(MirroredCloud, KeepsDistancesAndChangesSides) {
  const LocalCloud cloud = tubeCloud();
  const auto mirrored = mirroredClouds(cloud);
  const auto volume = [](const LocalCloud& points) {
    const Vec3 a = points.points[10].position_F - points.points[0].position_F;
    const Vec3 b = points.points[50].position_F - points.points[0].position_F;
    return a.cross(b).dot(points.points[90].position_F - points.points[0].position_F);
  };
  const double sides[] = {-1.0, -1.0, 1.0};
  for (size_t i = 0; i < mirrored.size(); ++i) {
    ASSERT_EQ(mirrored[i].points.size(), cloud.points.size());
    EXPECT_NEAR(volume(mirrored[i]), sides[i] * volume(cloud), 1e-9);
    for (size_t j = 0; j < cloud.points.size(); ++j) {
      const CloudPoint &before = cloud.points[j], &after = mirrored[i].points[j];
      EXPECT_NEAR(after.position_F.y(), before.position_F.y(), 1e-9);  // the vertical
      EXPECT_LE(after.normal_F.dot(after.view_F), 0.0);
      EXPECT_NEAR(after.covariance_F.trace(), before.covariance_F.trace(), 1e-12);
    }
  }
  EXPECT_GT((mirrored[0].points[0].position_F - mirrored[1].points[0].position_F).norm(), 1e-3);
}

}  // namespace
}  // namespace lodeline
