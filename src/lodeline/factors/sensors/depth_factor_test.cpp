#include "lodeline/factors/sensors/depth_factor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "lodeline/diagnostics.h"
#include "lodeline/factors/numeric_jacobian.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using Blocks = std::vector<Eigen::VectorXd>;

const Rigid3 kPose(so3::exp(Vec3(0.3, -0.4, 2.0)), Vec3(3.0, -2.0, 1.5));
const Vec3 kPort_B(0.1, -0.3, 0.2);
constexpr double kSurface_m = 7.5;  // depth read at the origin
constexpr double kScale = 0.975;
constexpr double kLag_s = 0.6;
constexpr double kSigma_m = 0.02;

Eigen::VectorXd scalar(double value) { return Eigen::VectorXd::Constant(1, value); }

Blocks trueBlocks(const Rigid3& pose = kPose) {
  return {poseVector(pose), scalar(kSurface_m), scalar(kScale), scalar(kLag_s)};
}

/// Reading of a port that sinks at 0.2 m/s; the lag is known to 0.1 s only.
CarriedDepth reading() {
  constexpr double kSpeed_m_per_s = -0.2;
  CarriedDepth depth;
  depth.lag_s = kLag_s - 0.1;
  depth.rise_m = kSpeed_m_per_s * depth.lag_s;
  depth.rise_by_lag_m_per_s = kSpeed_m_per_s;
  const double seen_m = (kPose * kPort_B).z() - kSpeed_m_per_s * kLag_s;
  depth.depth_m = kSurface_m - kScale * seen_m;
  depth.readings = 1;
  return depth;
}

double residualOf(const DepthFactor& factor, const Blocks& blocks) {
  std::vector<const double*> pointers;
  for (const auto& block : blocks) pointers.push_back(block.data());
  double residual = 0.0;
  EXPECT_TRUE(factor.Evaluate(pointers.data(), &residual, nullptr));
  return residual;
}

TEST(DepthFactor, IsZeroAtTheTruth) {
  EXPECT_NEAR(residualOf(DepthFactor(reading(), kPort_B, kSigma_m), trueBlocks()), 0.0, 1e-9);
}

TEST(DepthFactor, DeeperWaterAndLowerPortDisagreeWithOppositeSigns) {
  const DepthFactor factor(reading(), kPort_B, kSigma_m);
  Blocks higher = trueBlocks(Rigid3(kPose.rotation, kPose.translation + Vec3(0.0, 0.0, 0.1)));
  EXPECT_NEAR(residualOf(factor, higher), kScale * 0.1 / kSigma_m, 1e-9);
  Blocks deeper = trueBlocks();
  deeper[1][0] += 0.1;
  EXPECT_NEAR(residualOf(factor, deeper), -0.1 / kSigma_m, 1e-9);
}

TEST(DepthFactor, JacobiansAgreeWithNumericDifferentiation) {
  Blocks blocks = trueBlocks();
  blocks[1][0] += 0.3;
  blocks[2][0] += 0.02;
  blocks[3][0] -= 0.2;
  expectJacobiansMatch(DepthFactor(reading(), kPort_B, kSigma_m), blocks);
}

TEST(DepthFactor, SeesNeitherHorizontalPositionNorHeading) {
  const DepthFactor factor(reading(), kPort_B, kSigma_m);
  Blocks blocks = trueBlocks();
  blocks[1][0] += 0.3;
  const double before = residualOf(factor, blocks);
  const Rigid3 moved = Rigid3(so3::exp(Vec3(0.0, 0.0, 1.2)), Vec3(10.0, -20.0, 0.0)) * kPose;
  blocks[0] = poseVector(moved);
  EXPECT_NEAR(residualOf(factor, blocks), before, 1e-9);
}

TEST(DepthFactor, WhitenedNoiseHasUnitVariance) {
  constexpr int kRuns = 4000;
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  double squares = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    CarriedDepth noisy = reading();
    noisy.depth_m += kSigma_m * normal(random);
    const double e = residualOf(DepthFactor(noisy, kPort_B, kSigma_m), trueBlocks());
    squares += e * e / kRuns;
  }
  EXPECT_NEAR(squares, 1.0, 4.0 * std::sqrt(2.0 / kRuns));
}

TEST(DepthFactor, LinearizationPointsKeepTheHeightOfTheWorldUnobservable) {
  const Eigen::VectorXd first_pose =
      poseVector(Rigid3(so3::exp(Vec3(0.01, 0.02, -0.03)) * kPose.rotation, Vec3(3.0, -2.0, 1.4)));
  const double first_scale = 1.01;
  const DepthFactor factor(reading(), kPort_B, kSigma_m, first_pose.data(), &first_scale);
  const Blocks blocks = trueBlocks();
  Eigen::Matrix<double, 1, kPoseSize> by_pose;
  double by_surface = 0.0, residual = 0.0;
  const double* pointers[] = {blocks[0].data(), blocks[1].data(), blocks[2].data(), blocks[3].data()};
  double* jacobians[] = {by_pose.data(), &by_surface, nullptr, nullptr};
  ASSERT_TRUE(factor.Evaluate(pointers, &residual, jacobians));
  // A world lifted by 1 m is unobservable when the depth at its origin changes by the gauge's reading of that
  // metre.
  EXPECT_NEAR(by_pose[2] + first_scale * by_surface, 0.0, 1e-12);
  EXPECT_EQ(by_pose[5], 0.0);
}

TEST(DepthFactor, RefusesWhatCannotBeWeighed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CarriedDepth broken = reading();
  broken.depth_m = nan;
  EXPECT_THROW(DepthFactor(broken, kPort_B, kSigma_m), InputError);
  EXPECT_THROW(DepthFactor(reading(), kPort_B, 0.0), InputError);
  EXPECT_THROW(DepthFactor(reading(), kPort_B, nan), InputError);
}

}  // namespace
}  // namespace lodeline
