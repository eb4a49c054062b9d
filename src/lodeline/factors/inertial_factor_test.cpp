#include "lodeline/factors/inertial_factor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "lodeline/factors/numeric_jacobian.h"
#include "lodeline/imu/test_motion.h"

namespace lodeline {
namespace {

using Vec15 = Eigen::Matrix<double, 15, 1>;
using Mat15 = Preintegration::Mat15;
using Blocks = std::vector<Eigen::VectorXd>;  // pose k, motion k, pose k+1, motion k+1, maybe axes

const TestMotion kMotion;
const Vec3 kGyroscopeBias(0.01, -0.02, 0.015);
const Vec3 kAccelerometerBias(-0.05, 0.1, 0.08);

class Gaussian {
 public:
  Vec3 operator()(double sigma) { return sigma * Vec3(normal_(random_), normal_(random_), normal_(random_)); }

 private:
  std::mt19937 random_{3};
  std::normal_distribution<double> normal_;
};

Eigen::VectorXd motionVector(const NavigationState& state) {
  Eigen::VectorXd block(9);
  block << state.velocity_W, state.gyroscope_bias_B, state.accelerometer_bias_B;
  return block;
}

Blocks blocksOf(const NavigationState& k, const NavigationState& k1) {
  return {poseVector(k.world_from_body), motionVector(k), poseVector(k1.world_from_body), motionVector(k1)};
}

Blocks trueBlocks(const Preintegration& p) {
  return blocksOf(kMotion.state(p.start(), kGyroscopeBias, kAccelerometerBias),
                  kMotion.state(p.end(), kGyroscopeBias, kAccelerometerBias));
}

Blocks moved(Blocks blocks, double sigma, Gaussian& gaussian) {
  for (const int b : {0, 2}) {
    Eigen::Matrix<double, 6, 1> step;
    step << gaussian(sigma), gaussian(sigma);
    blocks[b] = poseVector(perturbed(poseFromBlock(blocks[b].data()), step));
    blocks[b + 1].head<3>() += gaussian(sigma);
    blocks[b + 1].segment<3>(3) += gaussian(0.1 * sigma);
    blocks[b + 1].tail<3>() += gaussian(sigma);
  }
  return blocks;
}

struct Evaluation {
  Vec15 residual;
  std::vector<Eigen::Matrix<double, 15, Eigen::Dynamic, Eigen::RowMajor>> jacobians;
};

Evaluation evaluate(const InertialFactor& factor, const Blocks& blocks) {
  Evaluation result;
  std::vector<const double*> parameters;
  std::vector<double*> jacobians;
  for (const auto& block : blocks) {
    parameters.push_back(block.data());
    result.jacobians.emplace_back(15, block.size());
  }
  for (auto& jacobian : result.jacobians) jacobians.push_back(jacobian.data());
  EXPECT_TRUE(factor.Evaluate(parameters.data(), result.residual.data(), jacobians.data()));
  return result;
}

// The factor without its whitening, so that no row hides behind another's weight.
class Unwhitened final : public ceres::CostFunction {
 public:
  Unwhitened(const Preintegration& preintegration, const Vec3& gravity_W, EstimatedAxes axes = {})
      : factor_(&preintegration, gravity_W, {}, axes), unwhiten_(preintegration.whitening().inverse()) {
    set_num_residuals(15);
    *mutable_parameter_block_sizes() = factor_.parameter_block_sizes();
  }
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    if (!factor_.Evaluate(parameters, residuals, jacobians)) return false;
    Eigen::Map<Vec15> e(residuals);
    e = (unwhiten_ * e).eval();
    for (int b = 0; jacobians != nullptr && b < static_cast<int>(parameter_block_sizes().size()); ++b) {
      Eigen::Map<Eigen::Matrix<double, 15, Eigen::Dynamic, Eigen::RowMajor>> jacobian(
          jacobians[b], 15, parameter_block_sizes()[b]);
      jacobian = (unwhiten_ * jacobian).eval();
    }
    return true;
  }

 private:
  InertialFactor factor_;
  Mat15 unwhiten_;
};

Preintegration preintegrate(double duration_s) {
  const auto samples = kMotion.readings(1.0, 1.0 + duration_s, 200.0, kGyroscopeBias, kAccelerometerBias);
  return Preintegration(samples, kGyroscopeBias, kAccelerometerBias, ImuCalibration());
}

TEST(InertialFactor, IsZeroAtTheTruth) {
  const Preintegration p = preintegrate(0.2);
  const Vec15 residual = evaluate(InertialFactor(&p, standardGravity_W()), trueBlocks(p)).residual;
  // In sigmas; the rest is the error of the integration itself.
  EXPECT_LT(residual.norm(), 0.05);
}

TEST(InertialFactor, IsExactlyZeroAtThePrediction) {
  const Preintegration p = preintegrate(0.5);
  NavigationState state = kMotion.state(p.start(), kGyroscopeBias, kAccelerometerBias);
  state.gyroscope_bias_B += Vec3(1e-3, -2e-3, 1e-3);
  state.accelerometer_bias_B += Vec3(0.02, -0.01, 0.03);
  const Blocks blocks = blocksOf(state, predict(state, p, standardGravity_W()));
  EXPECT_LT(evaluate(InertialFactor(&p, standardGravity_W()), blocks).residual.norm(), 1e-6);
}

TEST(InertialFactor, JacobiansAgreeWithNumericDifferentiation) {
  Gaussian gaussian;
  for (const double duration_s : {0.05, 0.5}) {
    const Preintegration p = preintegrate(duration_s);
    for (const double sigma : {1e-3, 0.1, 0.5}) {
      const Blocks blocks = moved(trueBlocks(p), sigma, gaussian);
      expectJacobiansMatch(InertialFactor(&p, standardGravity_W()), blocks, 1e-6);
      expectJacobiansMatch(Unwhitened(p, standardGravity_W()), blocks, 1e-6);
    }
  }
}

/// Blocks with the axes of one more sensor, off by some per cent.
Blocks withAxes(Blocks blocks, double sigma, Gaussian& gaussian) {
  SensorAxes axes;
  axes << gaussian(sigma), gaussian(sigma), gaussian(sigma);
  blocks.push_back(axes);
  return blocks;
}

TEST(InertialFactor, JacobiansByTheSensorsAxesAgreeWithNumericDifferentiation) {
  Gaussian gaussian;
  const Preintegration p = preintegrate(0.2);
  for (const EstimatedAxes axes : {EstimatedAxes{true, false}, {false, true}, {true, true}}) {
    for (const double sigma : {1e-3, 0.1}) {
      Blocks blocks = withAxes(moved(trueBlocks(p), sigma, gaussian), 0.02, gaussian);
      if (axes.gyroscope && axes.accelerometer) blocks = withAxes(blocks, 0.02, gaussian);
      expectJacobiansMatch(InertialFactor(&p, standardGravity_W(), {}, axes), blocks, 1e-6);
      expectJacobiansMatch(Unwhitened(p, standardGravity_W(), axes), blocks, 1e-6);
    }
  }
}

TEST(InertialFactor, WithAxesAsCalibratedIsTheOneWithout) {
  Gaussian gaussian;
  const Preintegration p = preintegrate(0.2);
  Blocks blocks = moved(trueBlocks(p), 0.01, gaussian);
  const Evaluation without = evaluate(InertialFactor(&p, standardGravity_W()), blocks);
  for (int sensor = 0; sensor < 2; ++sensor) blocks.push_back(SensorAxes::Zero());
  const Evaluation with = evaluate(InertialFactor(&p, standardGravity_W(), {}, {true, true}), blocks);
  EXPECT_EQ(with.residual, without.residual);
  for (size_t b = 0; b < 4; ++b) EXPECT_EQ(with.jacobians[b], without.jacobians[b]) << b;
  for (const size_t axes : {4, 5}) EXPECT_GT(with.jacobians[axes].norm(), 1.0) << axes;
}

TEST(InertialFactor, WritesOnlyTheJacobiansAskedFor) {
  const Preintegration p = preintegrate(0.1);
  const InertialFactor factor(&p, standardGravity_W());
  const Blocks blocks = trueBlocks(p);
  const double* parameters[] = {blocks[0].data(), blocks[1].data(), blocks[2].data(), blocks[3].data()};
  Eigen::Matrix<double, 15, 9, Eigen::RowMajor> motion_k;
  double* jacobians[] = {nullptr, motion_k.data(), nullptr, nullptr};
  Vec15 residual;
  ASSERT_TRUE(factor.Evaluate(parameters, residual.data(), jacobians));
  EXPECT_EQ(motion_k, evaluate(factor, blocks).jacobians[1]);
}

TEST(InertialFactor, WhitenedNoiseHasUnitCovariance) {
  constexpr int kRuns = 300;
  PreintegrationOptions options;
  options.noise_inflation = 1.0;
  options.motion_noise = MotionNoiseOptions::none();
  const ImuCalibration imu;
  const double root_rate = std::sqrt(imu.rate_hz);
  Gaussian gaussian;
  Vec15 sum = Vec15::Zero(), squares = Vec15::Zero();
  for (int run = 0; run < kRuns; ++run) {
    auto samples = kMotion.readings(1.0, 1.2, imu.rate_hz, kGyroscopeBias, kAccelerometerBias);
    Vec3 gyroscope_walk = Vec3::Zero(), accelerometer_walk = Vec3::Zero();
    for (ImuSample& sample : samples) {
      sample.angular_velocity_B +=
          gyroscope_walk + gaussian(imu.noise.gyroscope_density_rad_per_s_sqrtHz * root_rate);
      sample.specific_force_B +=
          accelerometer_walk + gaussian(imu.noise.accelerometer_density_m_per_s2_sqrtHz * root_rate);
      if (sample.time == samples.back().time) break;
      gyroscope_walk += gaussian(imu.noise.gyroscope_random_walk_rad_per_s2_sqrtHz / root_rate);
      accelerometer_walk += gaussian(imu.noise.accelerometer_random_walk_m_per_s3_sqrtHz / root_rate);
    }
    const Preintegration p(samples, kGyroscopeBias, kAccelerometerBias, imu, options);
    Blocks blocks = trueBlocks(p);
    blocks[3].segment<3>(3) += gyroscope_walk;
    blocks[3].tail<3>() += accelerometer_walk;
    const Vec15 residual = evaluate(InertialFactor(&p, standardGravity_W()), blocks).residual;
    sum += residual;
    squares += residual.cwiseAbs2();
  }
  EXPECT_NEAR(squares.sum() / kRuns, 15.0, 4.0 * std::sqrt(2.0 * 15.0 / kRuns));
  for (int i = 0; i < 15; ++i) {
    EXPECT_NEAR(sum[i] / kRuns, 0.0, 4.0 / std::sqrt(kRuns)) << i;
    EXPECT_NEAR(squares[i] / kRuns, 1.0, 4.0 * std::sqrt(2.0 / kRuns)) << i;
  }
}

TEST(InertialFactor, TurningAndMovingTheWorldAboutGravityChangesNothing) {
  const Preintegration p = preintegrate(0.3);
  const InertialFactor factor(&p, standardGravity_W());
  Gaussian gaussian;
  const Blocks blocks = moved(trueBlocks(p), 0.01, gaussian);
  const Rigid3 other_from_world(so3::exp(Vec3(0.0, 0.0, 2.0)), Vec3(10.0, -20.0, 5.0));
  Blocks other = blocks;
  for (const int b : {0, 2}) {
    other[b] = poseVector(other_from_world * poseFromBlock(blocks[b].data()));
    other[b + 1].head<3>() = other_from_world.rotation * Vec3(blocks[b + 1].head<3>());
  }
  const Vec15 residual = evaluate(factor, blocks).residual;
  EXPECT_LT((evaluate(factor, other).residual - residual).norm(), 1e-8 * (1.0 + residual.norm()));
  // A tilt of the world must change the residual.
  const Quat tilt = so3::exp(Vec3(0.01, 0.0, 0.0));
  for (const int b : {0, 2}) {
    other[b] = poseVector(Rigid3(tilt, Vec3::Zero()) * poseFromBlock(blocks[b].data()));
    other[b + 1].head<3>() = tilt * Vec3(blocks[b + 1].head<3>());
  }
  EXPECT_GT((evaluate(factor, other).residual - residual).norm(), 0.1);
}

TEST(InertialFactor, TakesJacobiansAtLinearizationPointsAndTheResidualAtTheValue) {
  const Preintegration p = preintegrate(0.3);
  Gaussian gaussian;
  const Blocks first = moved(trueBlocks(p), 0.05, gaussian);
  const Blocks now = moved(first, 0.05, gaussian);
  const InertialFactor plain(&p, standardGravity_W());
  const InertialFactor anchored(&p, standardGravity_W(),
                                {first[0].data(), first[1].data(), first[2].data(), first[3].data()});
  EXPECT_EQ(evaluate(anchored, now).residual, evaluate(plain, now).residual);
  EXPECT_EQ(evaluate(anchored, now).jacobians, evaluate(plain, first).jacobians);
  EXPECT_NE(evaluate(anchored, now).jacobians, evaluate(plain, now).jacobians);

  // The axes have linearization points like the other blocks.
  const auto withBoth = [&] { return withAxes(withAxes(first, 0.01, gaussian), 0.01, gaussian); };
  const Blocks first_axes = withBoth(), now_axes = withBoth();
  const InertialFactor anchored_axes(
      &p, standardGravity_W(),
      {nullptr, nullptr, nullptr, nullptr, first_axes[4].data(), first_axes[5].data()}, {true, true});
  const InertialFactor plain_axes(&p, standardGravity_W(), {}, {true, true});
  EXPECT_EQ(evaluate(anchored_axes, now_axes).residual, evaluate(plain_axes, now_axes).residual);
  EXPECT_EQ(evaluate(anchored_axes, now_axes).jacobians, evaluate(plain_axes, first_axes).jacobians);

  // Only pose k has a linearization point.
  const InertialFactor partly(&p, standardGravity_W(), {first[0].data(), nullptr, nullptr, nullptr});
  EXPECT_EQ(evaluate(partly, now).jacobians, evaluate(plain, {first[0], now[1], now[2], now[3]}).jacobians);
}

// With all Jacobians at one linearization point, a yaw about gravity and a translation of the world stay
// unobservable.
TEST(InertialFactor, LinearizationPointsKeepYawAndPositionUnobservable) {
  const Preintegration p = preintegrate(0.3);
  Gaussian gaussian;
  const Blocks first = moved(trueBlocks(p), 0.05, gaussian);
  const InertialFactor anchored(&p, standardGravity_W(),
                                {first[0].data(), first[1].data(), first[2].data(), first[3].data()});
  const auto jacobians = evaluate(anchored, moved(first, 0.1, gaussian)).jacobians;
  const Vec3 up = Vec3::UnitZ();
  Vec15 effect = Vec15::Zero();
  for (const int b : {0, 2}) {
    Eigen::Matrix<double, 7, 1> pose_change;
    pose_change << up.cross(Vec3(first[b].head<3>())), up, 0.0;
    Eigen::Matrix<double, 9, 1> motion_change = Eigen::Matrix<double, 9, 1>::Zero();
    motion_change.head<3>() = up.cross(Vec3(first[b + 1].head<3>()));
    effect += jacobians[b] * pose_change + jacobians[b + 1] * motion_change;
  }
  EXPECT_LT(effect.norm(), 1e-9 * jacobians[0].norm());
  EXPECT_LT((jacobians[0].leftCols<3>() + jacobians[2].leftCols<3>()).norm(), 1e-9 * jacobians[0].norm());
}

}  // namespace
}  // namespace lodeline
