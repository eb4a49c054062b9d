#include "lodeline/estimator/start.h"

#include <gtest/gtest.h>

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
  const Prior prior = startPrior(frame, options, 0.07, false);
  ASSERT_EQ(prior.blocks.size(), 2u);
  EXPECT_EQ(prior.blocks[0].value, frame.pose.data());
  EXPECT_EQ(prior.blocks[1].value, frame.motion.data());
  EXPECT_EQ(prior.blocks[1].first_estimate.head<3>(), state.velocity_W);
  EXPECT_EQ(prior.offset.norm(), 0.0);
  Eigen::VectorXd expected(15);
  expected << Vec3::Constant(options.position_sigma_m), 0.07, 0.07, options.yaw_sigma_rad,
      Vec3::Constant(options.velocity_sigma_m_per_s), Vec3::Constant(options.gyroscope_bias_sigma_rad_per_s),
      Vec3::Constant(options.accelerometer_bias_sigma_m_per_s2);
  EXPECT_LT((sigmasOf(prior) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(StartPrior, IsSurerOfTheVelocityWhenStill) {
  const InitialStateOptions options;
  Frame frame;
  EXPECT_NEAR(sigmasOf(startPrior(frame, options, 0.07, true))[6], options.velocity_sigma_still_m_per_s,
              1e-12);
}

TEST(StartPrior, NeverBelievesTheTiltTooMuch) {
  const InitialStateOptions options;
  Frame frame;
  EXPECT_NEAR(sigmasOf(startPrior(frame, options, 1e-9, true))[3], options.tilt_sigma_min_rad, 1e-12);
}

}  // namespace
}  // namespace lodeline
