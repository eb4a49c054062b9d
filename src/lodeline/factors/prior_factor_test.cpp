#include "lodeline/factors/prior_factor.h"

#include <gtest/gtest.h>

#include "lodeline/factors/numeric_jacobian.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

Prior makePrior(const Rigid3& pose, const Eigen::VectorXd& motion) {
  Prior prior;
  prior.blocks.resize(2);
  prior.blocks[0].linearization_point = poseVector(pose);
  prior.blocks[1].linearization_point = motion;
  Eigen::MatrixXd full = Eigen::MatrixXd::Random(15, 15) + 5.0 * Eigen::MatrixXd::Identity(15, 15);
  prior.sqrt_information = full.triangularView<Eigen::Upper>();
  prior.offset = Eigen::VectorXd::Zero(15);
  return prior;
}

TEST(PriorFactor, IsItsOffsetAtTheLinearizationPoint) {
  const Rigid3 pose(so3::exp(Vec3(0.2, -0.4, 2.0)), Vec3(1, 2, 3));
  const Eigen::VectorXd motion = Eigen::VectorXd::Random(9);
  Prior prior = makePrior(pose, motion);
  prior.offset.setLinSpaced(15, -1.0, 1.0);
  const PriorFactor factor(prior);
  const Eigen::VectorXd pose_block = poseVector(pose);
  const double* parameters[2] = {pose_block.data(), motion.data()};
  Eigen::VectorXd residual(15);
  ASSERT_TRUE(factor.Evaluate(parameters, residual.data(), nullptr));
  EXPECT_LT((residual - prior.offset).norm(), 1e-12);
}

TEST(PriorFactor, JacobiansMatchNumericDifferentiationAtTheLinearizationPoint) {
  const Rigid3 pose(so3::exp(Vec3(0.2, -0.4, 2.0)), Vec3(1, 2, 3));
  const Eigen::VectorXd motion = Eigen::VectorXd::Random(9);
  const Prior prior = makePrior(pose, motion);
  expectJacobiansMatch(PriorFactor(prior), {poseVector(pose), motion});
}

TEST(PriorFactor, RisesWithTheSquareOfTheDifference) {
  const Rigid3 pose;
  const Eigen::VectorXd motion = Eigen::VectorXd::Zero(9);
  const Prior prior = makePrior(pose, motion);
  const PriorFactor factor(prior);
  Eigen::Matrix<double, 6, 1> step;
  step << 0.1, -0.2, 0.3, 0.05, 0.06, -0.07;
  const Eigen::VectorXd moved = poseVector(perturbed(pose, step));
  const double* parameters[2] = {moved.data(), motion.data()};
  Eigen::VectorXd residual(15);
  ASSERT_TRUE(factor.Evaluate(parameters, residual.data(), nullptr));
  EXPECT_NEAR(residual.norm(), (prior.sqrt_information.leftCols(6) * step).norm(), 1e-12);
}

}  // namespace
}  // namespace lodeline
