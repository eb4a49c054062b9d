#include "lodeline/problem/state/parameter_block.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "lodeline/estimator/initialization/start.h"
#include "lodeline/estimator/solver/window_solver.h"
#include "lodeline/estimator/solver/window_update.h"
#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/problem/covariance.h"
#include "lodeline/problem/marginalization/marginalizer.h"
#include "lodeline/problem/window_terms.h"

namespace lodeline {
namespace {

// A moving rig with two additional states: a vector as small as a field in tesla, and a pose. A prior
// correlates them with the first frame.
class ParameterBlockTest : public testing::Test {
 protected:
  static constexpr int kFrames = 6;
  static constexpr double kFrameDistance_s = 0.1;

  ParameterBlockTest() {
    TestSceneOptions options;
    options.duration_s = 1.0 + kFrames * kFrameDistance_s;
    options.points.tracks = 20;
    options.points.frame_rate_hz = 1.0 / kFrameDistance_s;
    TestScene scene(options);
    for (int k = 0; k < kFrames; ++k) test_.add(*scene.next(), k == 2);
    vector_ = &test_.window.add({"vector", {2e-5, -1e-5, -4e-5}, std::nullopt, 0.0});
    pose_ = &test_.window.add({"pose", std::vector<double>(kPoseSize), std::nullopt, 0.0});
    poseToBlock(Rigid3(so3::exp(Vec3(0.1, 0.2, 2.0)), Vec3(0.1, 0.0, -0.1)), pose_->value.data());
  }

  Frame& first() { return *test_.window.frames().front(); }

  // Prior on the two states, and on their sum with the first frame's position and rotation.
  Prior coupledPrior() {
    Prior prior = startPrior(first(), test_.options.initial_state, 0.05);
    prior.append(vector_->value.data(), 3, Vec3::Constant(1e-6));
    prior.append(pose_->value.data(), kPoseSize, Eigen::VectorXd::Constant(6, 0.02));
    prior.sqrt_information.block<3, 3>(3, 15) = 1e6 * Mat3::Identity();
    prior.sqrt_information.block<6, 6>(0, 18) = 50.0 * Mat6::Identity();
    return prior;
  }

  Eigen::MatrixXd covariance(const Prior& prior, const std::vector<const double*>& blocks) {
    return covarianceOf(linearize(collectTerms(test_.window, prior, test_.factors)), blocks);
  }

  TestWindow test_;
  ParameterBlock* vector_ = nullptr;
  ParameterBlock* pose_ = nullptr;
};

double relativeDifference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::VectorXd scale = b.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

TEST_F(ParameterBlockTest, IsFoundByItsName) {
  EXPECT_EQ(test_.window.findGlobal("vector"), vector_);
  EXPECT_EQ(test_.window.findGlobal("nothing"), nullptr);
  EXPECT_EQ(vector_->tangentSize(), 3);
  EXPECT_EQ(pose_->tangentSize(), 6);
}

TEST_F(ParameterBlockTest, IsSolvedForByBothSolvers) {
  const Prior prior = coupledPrior();
  const std::vector<double> vector_wanted = vector_->value;
  const Rigid3 pose_wanted = poseFromBlock(pose_->value.data());
  for (const bool ceres : {true, false}) {
    vector_->value = {5e-5, 0.0, 1e-5};
    poseToBlock(Rigid3(so3::exp(Vec3(0.0, 0.1, 1.9)), Vec3(0.2, 0.2, 0.2)), pose_->value.data());
    if (ceres) {
      solveWithCeres(test_.window, prior, test_.factors, {50, 1e-16});
    } else {
      updateWindow(test_.window, prior, test_.factors, {50, 1e-16});
    }
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(vector_->value[i], vector_wanted[i], 1e-8) << ceres;
    EXPECT_LT(perturbationBetween(pose_wanted, poseFromBlock(pose_->value.data())).norm(), 1e-3) << ceres;
  }
}

TEST_F(ParameterBlockTest, KeepsItsCovarianceAndCorrelationThroughMarginalization) {
  const Eigen::MatrixXd before = covariance(
      coupledPrior(), {test_.window.newest().pose.data(), vector_->value.data(), pose_->value.data()});
  Marginalizer marginalizer(test_.factors);
  marginalizer.start(coupledPrior());
  marginalizer.marginalizeToSize(test_.window, {.recent_frames = 2, .keyframes = 1});
  ASSERT_EQ(test_.window.frames().size(), 3u);
  EXPECT_TRUE(vector_->first && pose_->first) << "what the prior touches keeps a linearization point";
  const Eigen::MatrixXd after = covariance(
      marginalizer.prior(), {test_.window.newest().pose.data(), vector_->value.data(), pose_->value.data()});
  EXPECT_LT(relativeDifference(after, before), 1e-4);
  EXPECT_GT(std::abs(before(3, 6)), 0.1 * std::sqrt(before(3, 3) * before(6, 6)))
      << "nothing is coupled here";
}

TEST_F(ParameterBlockTest, WhatItWasToldCanBeTakenBack) {
  vector_->is_correlation_wanted = true;
  constexpr double kMore = 3.0;
  Prior told = coupledPrior();
  told.sqrt_information.block<3, 3>(15, 15) *= kMore;
  const auto with = jointCovariance(test_.window, told, test_.factors);
  const auto without = jointCovariance(test_.window, coupledPrior(), test_.factors);
  const Mat3 information = (kMore * kMore - 1.0) * 1e12 * Mat3::Identity();
  const double *vector = vector_->value.data(), *pose = test_.window.newest().pose.data();
  const JointCovariance taken_back = with.without(vector, information);
  EXPECT_LT(relativeDifference(taken_back.newest(), without.newest()), 1e-6);
  EXPECT_LT(relativeDifference(taken_back.between(vector, vector), without.between(vector, vector)), 1e-6);
  EXPECT_TRUE(taken_back.between(pose, vector).isApprox(without.between(pose, vector), 1e-6));
  EXPECT_GT(relativeDifference(with.newest(), without.newest()), 0.01) << "it added no information";
  EXPECT_LT(relativeDifference(with.without(vector, -information).newest(), with.newest()), 1e-12);
}

TEST_F(ParameterBlockTest, WalksWhileFramesAreMarginalized) {
  vector_->walk_per_sqrt_s = 2e-6;
  const std::vector<const double*> both = {first().pose.data(), vector_->value.data()};
  const Mat3 before = covariance(coupledPrior(), {vector_->value.data()});
  Marginalizer marginalizer(test_.factors);
  marginalizer.start(coupledPrior());
  marginalizer.marginalizeToSize(test_.window, {.recent_frames = 2, .keyframes = 1});
  const double elapsed_s = (kFrames - 2) * kFrameDistance_s;
  const Mat3 expected = before + 4e-12 * elapsed_s * Mat3::Identity();
  EXPECT_LT(relativeDifference(covariance(marginalizer.prior(), {vector_->value.data()}), expected), 1e-4);
  EXPECT_GT(relativeDifference(before, expected), 0.1);
  // The estimate itself does not change.
  const std::vector<double> value = vector_->value;
  updateWindow(test_.window, marginalizer.prior(), test_.factors, {10, 1e-16});
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(vector_->value[i], value[i], 1e-9);
}

TEST_F(ParameterBlockTest, IsLessKnownOnceAfterASuddenChange) {
  vector_->sudden_variance = 3e-12;
  const Mat3 before = covariance(coupledPrior(), {vector_->value.data()});
  Marginalizer marginalizer(test_.factors);
  marginalizer.start(coupledPrior());
  marginalizer.marginalizeToSize(test_.window, {.recent_frames = 2, .keyframes = 1});
  EXPECT_LT(relativeDifference(covariance(marginalizer.prior(), {vector_->value.data()}),
                               before + 3e-12 * Mat3::Identity()),
            1e-4);
  EXPECT_EQ(vector_->sudden_variance, 0.0);
}

TEST_F(ParameterBlockTest, ForgottenLeavesBehindWhatItSaidOfOthers) {
  const std::vector<const double*> others = {first().pose.data(), first().motion.data(), pose_->value.data()};
  const Eigen::MatrixXd before = covariance(coupledPrior(), others);
  Marginalizer marginalizer(test_.factors);
  marginalizer.start(coupledPrior());
  marginalizer.forget(test_.window, *vector_);
  for (const Prior::Block& block : marginalizer.prior().blocks)
    EXPECT_NE(block.value, vector_->value.data()) << "still in the prior";
  EXPECT_LT(relativeDifference(covariance(marginalizer.prior(), others), before), 1e-5);
  // The state may be added again, with the new prior only.
  marginalizer.addKnowledge(*vector_, Vec3::Constant(3e-6));
  const Mat3 afresh = covariance(marginalizer.prior(), {vector_->value.data()});
  EXPECT_LT(relativeDifference(afresh, 9e-12 * Mat3::Identity()), 1e-6);
  marginalizer.forget(test_.window, *vector_);
  marginalizer.forget(test_.window, *vector_);  // no entry in the prior: no effect
}

}  // namespace
}  // namespace lodeline
