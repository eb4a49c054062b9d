#include "lodeline/mapping/cloud/shape_problem.h"

#include <gtest/gtest.h>

#include <random>

#include "lodeline/geometry/so3.h"
#include "lodeline/geometry/squared.h"
#include "lodeline/mapping/cloud/local_cloud.h"

namespace lodeline {
namespace {

/// Three square walls that do not touch, seen from the origin, with noise along their normals.
LocalCloud walls(double noise_m, std::mt19937_64& random, double sigma_m) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(-0.9, 0.9);
  LocalCloud cloud;
  for (int wall = 0; wall < 3; ++wall) {
    for (int i = 0; i < 80; ++i) {
      CloudPoint point;
      point.position_F = Vec3(unit(random), unit(random), unit(random));
      point.position_F[wall] = 3.0 + noise_m * normal(random);
      point.view_F = point.position_F;
      point.covariance_F = squared(sigma_m) * Mat3::Identity();
      cloud.points.push_back(point);
    }
  }
  LocalCloudOptions options;
  options.voxel_m = 1e-6;
  finishCloud(cloud, options);
  return cloud;
}

LocalCloud seenFrom(LocalCloud cloud, const Rigid3& old_from_new) {
  const Rigid3 new_from_old = old_from_new.inverse();
  for (CloudPoint& point : cloud.points) {
    point.position_F = new_from_old * point.position_F;
    point.view_F = new_from_old.rotation * point.view_F;
    point.normal_F = new_from_old.rotation * point.normal_F;
  }
  cloud.up_F = new_from_old.rotation * cloud.up_F;
  return cloud;
}

const Rigid3 kTruth(so3::exp(Vec3(0.0, 0.0, 2.5)) * so3::exp(Vec3(0.4, -0.3, 0.0)), Vec3(0.5, -0.7, 0.2));

TEST(ShapeProblem, IsZeroAtTheTruth) {
  std::mt19937_64 random(1);
  const LocalCloud old_cloud = walls(0.0, random, 0.01);
  const LocalCloud new_cloud = seenFrom(walls(0.0, random, 0.01), kTruth);
  const ShapeProblem problem(old_cloud, new_cloud, 10);
  const auto rows = problem.rows({kTruth, 0.0});
  ASSERT_GT(rows.size(), 150u);
  for (const ShapeRow& row : rows) EXPECT_NEAR(row.error, 0.0, 1e-9);
}

TEST(ShapeProblem, HasTheJacobianOfItsErrors) {
  std::mt19937_64 random(2);
  const LocalCloud old_cloud = walls(0.0, random, 0.01);
  const LocalCloud new_cloud = seenFrom(walls(0.0, random, 0.01), kTruth);
  const ShapeProblem problem(old_cloud, new_cloud, 10);
  Vec5 away;
  away << 0.05, -0.03, 0.04, 0.02, 0.01;
  const ShapeState state = problem.moved({kTruth, 0.0}, away);
  const auto rows = problem.rows(state);
  ASSERT_GT(rows.size(), 100u);
  for (int i = 0; i < 5; ++i) {
    const double h = 1e-6;
    const auto after = problem.rows(problem.moved(state, h * Vec5::Unit(i)));
    const auto before = problem.rows(problem.moved(state, -h * Vec5::Unit(i)));
    size_t compared = 0;
    for (size_t j = 0; j < std::min({rows.size(), after.size(), before.size()}); ++j) {
      if (after[j].point != rows[j].point || before[j].point != rows[j].point) continue;
      EXPECT_NEAR((after[j].error - before[j].error) / (2.0 * h), rows[j].jacobian[i], 2e-3) << i;
      ++compared;
    }
    EXPECT_GT(compared, 80u);
  }
}

TEST(ShapeProblem, HasTheDerivativesByScaleAndTilt) {
  std::mt19937_64 random(3);
  const LocalCloud old_cloud = walls(0.0, random, 0.01), plain = walls(0.0, random, 0.01);
  const ShapeProblem problem(old_cloud, plain, 10);
  const auto rows = problem.rows({});
  const double h = 1e-6;
  LocalCloud larger = plain;
  for (CloudPoint& point : larger.points) point.position_F += h * point.view_F;
  const auto scaled = ShapeProblem(old_cloud, larger, 10).rows({});
  ASSERT_EQ(rows.size(), scaled.size());
  for (size_t i = 0; i < rows.size(); ++i)
    EXPECT_NEAR((scaled[i].error - rows[i].error) / h, rows[i].considered[1], 1e-2);
  LocalCloud larger_old = old_cloud;
  for (CloudPoint& point : larger_old.points) point.position_F += h * point.view_F;
  const auto by_old = ShapeProblem(larger_old, plain, 10).rows({});
  ASSERT_EQ(rows.size(), by_old.size());
  for (size_t i = 0; i < rows.size(); ++i)
    EXPECT_NEAR((by_old[i].error - rows[i].error) / h, rows[i].considered[0], 1e-2);
  const Mat32 axes = tangentBasis(old_cloud.up_F);
  for (int axis = 0; axis < 2; ++axis) {
    LocalCloud tilted = plain;
    const Quat tilt = so3::exp(h * axes.col(axis));
    for (CloudPoint& point : tilted.points)
      point.position_F = problem.centroid_N() + tilt * (point.position_F - problem.centroid_N());
    const auto by_tilt = ShapeProblem(old_cloud, tilted, 10).rows({});
    ASSERT_EQ(rows.size(), by_tilt.size());
    for (size_t i = 0; i < rows.size(); ++i)
      EXPECT_NEAR((by_tilt[i].error - rows[i].error) / h, rows[i].considered[2 + axis], 1e-2);
  }
}

TEST(ShapeProblem, WhitensItsErrors) {
  std::mt19937_64 random(4);
  double sum = 0.0;
  size_t number = 0;
  for (int run = 0; run < 30; ++run) {
    const LocalCloud old_cloud = walls(0.02, random, 0.02);
    const LocalCloud new_cloud = seenFrom(walls(0.03, random, 0.03), kTruth);
    const ShapeProblem problem(old_cloud, new_cloud, 10);
    for (const ShapeRow& row : problem.rows({kTruth, 0.0})) {
      sum += squared(row.error);
      ++number;
    }
  }
  // 30 runs with 3 walls of about 20 independent planes: 1 +- 0.05. The thickness of planes is rounded up
  // where the noise explains more than all of it.
  EXPECT_NEAR(sum / static_cast<double>(number), 1.0, 0.2);
}

TEST(ShapeProblem, MovesByItsParameters) {
  std::mt19937_64 random(5);
  const LocalCloud old_cloud = walls(0.0, random, 0.01);
  const LocalCloud new_cloud = seenFrom(walls(0.0, random, 0.01), kTruth);
  const ShapeProblem problem(old_cloud, new_cloud, 10);
  Vec5 step;
  step << 0.3, -0.2, 0.1, 0.4, 0.05;
  const ShapeState state = problem.moved({kTruth, 0.01}, step);
  EXPECT_LT((problem.difference(kTruth, state.old_from_new) - step.head<4>()).norm(), 1e-9);
  EXPECT_NEAR(state.offset_m, 0.06, 1e-12);
  // [centroid, yaw] by [dp, dtheta] of the pose, numerically.
  const Mat46 by_pose = problem.parametersByPose(kTruth);
  for (int i = 0; i < 3; ++i) {
    const double h = 1e-6;
    const Rigid3 turned((so3::exp(h * Vec3::Unit(i)) * kTruth.rotation).normalized(), kTruth.translation);
    EXPECT_LT((problem.difference(kTruth, turned) / h - by_pose.col(3 + i)).norm(), 1e-4);
  }
}

TEST(ShapeProblem, SetsAPredictionUpright) {
  std::mt19937_64 random(6);
  const LocalCloud old_cloud = walls(0.0, random, 0.01);
  const LocalCloud new_cloud = seenFrom(walls(0.0, random, 0.01), kTruth);
  const ShapeProblem problem(old_cloud, new_cloud, 10);
  const Rigid3 leaning((so3::exp(Vec3(0.03, 0.04, 0.0)) * kTruth.rotation).normalized(), kTruth.translation);
  double tilt_rad = 0.0;
  const Rigid3 upright = problem.upright(leaning, tilt_rad);
  EXPECT_NEAR(tilt_rad, 0.05, 1e-9);
  EXPECT_LT((upright.rotation * new_cloud.up_F - old_cloud.up_F).norm(), 1e-9);
  EXPECT_LT((upright * problem.centroid_N() - leaning * problem.centroid_N()).norm(), 1e-12);
}

TEST(ShapeProblem, HasNoRowsWithoutSurface) {
  std::mt19937_64 random(7);
  const LocalCloud cloud = walls(0.0, random, 0.01);
  const LocalCloud empty;
  EXPECT_TRUE(ShapeProblem(empty, cloud, 10).rows({}).empty());
  EXPECT_TRUE(ShapeProblem(cloud, empty, 10).rows({}).empty());
  // The other side of a wall is no counterpart.
  LocalCloud behind = cloud;
  for (CloudPoint& point : behind.points) point.normal_F = -point.normal_F;
  for (const ShapeRow& row : ShapeProblem(cloud, behind, 10).rows({}))
    EXPECT_TRUE(behind.points[row.point].normal_F.isZero());
}

}  // namespace
}  // namespace lodeline
