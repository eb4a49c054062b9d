#include "lodeline/estimator/initialization/start.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "lodeline/estimator/magnetometer/heading_alignment.h"
#include "lodeline/factors/sensors/magnetometer_field_factor.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/imu/gravity.h"
#include "lodeline/imu/gravity_alignment.h"

namespace lodeline {
namespace {

Eigen::VectorXd sigmasOf(const Prior& prior) {
  const Eigen::MatrixXd information = prior.sqrt_information.transpose() * prior.sqrt_information;
  EXPECT_TRUE(information.isDiagonal());
  return information.diagonal().cwiseSqrt().cwiseInverse();
}

TEST(StartPrior, HoldsTheStateWithTheStatedSigmas) {
  InitialStateOptions options;
  Frame frame;
  NavigationState state;
  state.velocity_W = Vec3(1, 2, 3);
  frame.setState(state);
  const Prior prior = startPrior(frame, options, 0.07);
  ASSERT_EQ(prior.blocks.size(), 2u);
  EXPECT_EQ(prior.blocks[0].value, frame.pose.data());
  EXPECT_EQ(prior.blocks[1].value, frame.motion.data());
  EXPECT_EQ(prior.blocks[1].linearization_point.head<3>(), state.velocity_W);
  EXPECT_EQ(prior.offset.norm(), 0.0);
  Eigen::VectorXd expected(15);
  expected << Vec3::Constant(options.position_sigma_m), 0.07, 0.07, options.yaw_sigma_rad,
      Vec3::Constant(options.velocity_sigma_m_per_s), Vec3::Constant(options.gyroscope_bias_sigma_rad_per_s),
      Vec3::Constant(options.accelerometer_bias_sigma_m_per_s2);
  EXPECT_LT((sigmasOf(prior) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(StartPrior, NeverBelievesTheTiltTooMuch) {
  const InitialStateOptions options;
  Frame frame;
  EXPECT_NEAR(sigmasOf(startPrior(frame, options, 1e-9))[3], options.tilt_sigma_min_rad, 1e-12);
}

// A rig at rest whose accelerometer has a bias and whose tilt comes from its readings.
TEST(StartPrior, TiltAndAccelerometerBiasAnswerForEachOther) {
  const Quat true_attitude = so3::exp(Vec3(0.4, -1.1, 2.0));
  const Vec3 bias_B(0.1, 0.28, -0.15);
  const Vec3 force_B = true_attitude.conjugate() * (kStandardGravity * Vec3::UnitZ()) + bias_B;
  Frame frame;
  NavigationState state;
  state.world_from_body.rotation = levelWithZeroYaw(force_B.normalized());
  frame.setState(state);
  InitialStateOptions options;
  Prior prior = startPrior(frame, options, 0.01);
  tieTiltToAccelerometerBias(frame, kStandardGravity, &prior);

  const Eigen::MatrixXd covariance = (prior.sqrt_information.transpose() * prior.sqrt_information).inverse();
  const double by_bias = options.accelerometer_bias_sigma_m_per_s2 / kStandardGravity;
  EXPECT_NEAR(std::sqrt(covariance(3, 3)), std::hypot(0.01, by_bias), 1e-9);
  EXPECT_NEAR(std::sqrt(covariance(4, 4)), std::hypot(0.01, by_bias), 1e-9);
  EXPECT_NEAR(std::sqrt(covariance(14, 14)), options.accelerometer_bias_sigma_m_per_s2, 1e-9);

  // At the truth the tilt residual is of second order.
  const Quat yaw = so3::exp(headingBetween(true_attitude, state.world_from_body.rotation) * Vec3::UnitZ());
  state.world_from_body.rotation = yaw * true_attitude;
  const auto tilt = [&](const Vec3& bias) {
    state.accelerometer_bias_B = bias;
    frame.setState(state);
    const double* values[] = {frame.pose.data(), frame.motion.data()};
    return Eigen::VectorXd(prior.sqrt_information * prior.difference(values)).segment<2>(3).norm();
  };
  EXPECT_LT(tilt(bias_B), 0.1);
  EXPECT_GT(tilt(Vec3::Zero()), 1.5) << "this bias tilts nothing";

  // The same holds in a rotated world.
  Window window;
  auto added = std::make_unique<Frame>();
  state.world_from_body.rotation = levelWithZeroYaw(force_B.normalized());
  state.accelerometer_bias_B.setZero();
  added->setState(state);
  Frame& first = window.add(std::move(added));
  Prior turned = startPrior(first, options, 0.01);
  tieTiltToAccelerometerBias(first, kStandardGravity, &turned);
  turnWorld(1.2, &window, &turned);
  state = first.state();
  state.world_from_body.rotation = so3::exp(1.2 * Vec3::UnitZ()) * yaw * true_attitude;
  state.accelerometer_bias_B = bias_B;
  first.setState(state);
  const double* values[] = {first.pose.data(), first.motion.data()};
  EXPECT_LT((turned.sqrt_information * turned.difference(values)).segment(3, 2).norm(), 0.1);
}

}  // namespace
}  // namespace lodeline
