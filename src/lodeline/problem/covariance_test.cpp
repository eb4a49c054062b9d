#include "lodeline/problem/covariance.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

namespace lodeline {
namespace {

/// Two blocks of three coordinates with a joint covariance.
class CovarianceTest : public testing::Test {
 protected:
  NormalEquations system(const Eigen::MatrixXd& hessian) {
    NormalEquations system;
    system.add({{first_, 3, 0}, {second_, 3, 3}}, hessian, Eigen::VectorXd::Zero(6));
    return system;
  }
  Eigen::MatrixXd wellKnown() const {
    Eigen::MatrixXd root = Eigen::MatrixXd::Identity(6, 6);
    root(0, 3) = root(1, 4) = 0.8;
    root(2, 5) = -0.5;
    return 4.0 * root.transpose() * root;
  }
  double first_[3] = {}, second_[3] = {};
};

TEST_F(CovarianceTest, IsTheInverseOfTheHessian) {
  const Eigen::MatrixXd covariance = covarianceOf(system(wellKnown()), {first_, second_});
  EXPECT_LT((covariance - wellKnown().inverse()).norm(), 1e-12);
  EXPECT_TRUE(isCovariance(covariance));
}

TEST_F(CovarianceTest, ASystemThatRoundingLeftIndefiniteIsUnknownAndNotExact) {
  // The information on the blocks' difference is 10^20 times that on the blocks, so doubles contain nothing
  // of the latter; rounding makes it slightly smaller.
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(6, 6);
  hessian.topLeftCorner<3, 3>().diagonal().setConstant(1e20);
  hessian.bottomRightCorner<3, 3>().diagonal().setConstant(1e20 * (1.0 - 1e-15));
  hessian.topRightCorner<3, 3>().diagonal().setConstant(-1e20);
  hessian.bottomLeftCorner<3, 3>().diagonal().setConstant(-1e20);
  const Eigen::MatrixXd covariance = covarianceOf(system(hessian), {second_});
  EXPECT_EQ(covariance.diagonal().minCoeff(), kUnknownVariance);
  EXPECT_FALSE(isCovariance(covariance));
}

TEST_F(CovarianceTest, VariancesThatAreNoneAreNoCovariance) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(3, 3);
  EXPECT_TRUE(isCovariance(matrix));
  for (const double variance :
       {0.0, -3.2e-4, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    matrix(1, 1) = variance;
    EXPECT_FALSE(isCovariance(matrix)) << variance;
  }
}

TEST_F(CovarianceTest, TakesInformationBack) {
  const NormalEquations known = system(wellKnown());
  const JointCovariance joint(known, {first_, second_}, covarianceOf(known, {first_, second_}));
  Eigen::MatrixXd information = Eigen::Vector3d(1.0, 0.5, 0.0).asDiagonal();
  Eigen::MatrixXd without = wellKnown();
  without.topLeftCorner<3, 3>() -= information;
  const Eigen::MatrixXd expected = without.inverse();
  const JointCovariance found = joint.without(first_, information);
  EXPECT_LT((found.between(first_, first_) - expected.topLeftCorner<3, 3>()).norm(), 1e-12);
  EXPECT_LT((found.between(first_, second_) - expected.topRightCorner<3, 3>()).norm(), 1e-12);
  EXPECT_LT((found.between(second_, second_) - expected.bottomRightCorner<3, 3>()).norm(), 1e-12);
}

TEST_F(CovarianceTest, MoreInformationThanThereIsLeavesALargeVarianceAndNoNegativeOne) {
  const NormalEquations known = system(wellKnown());
  const Eigen::MatrixXd before = covarianceOf(known, {first_, second_});
  const JointCovariance joint(known, {first_, second_}, before);
  // Twice the information on the first coordinate alone.
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(3, 3);
  information(0, 0) = 2.0 / before(0, 0);
  const JointCovariance without = joint.without(first_, information);
  EXPECT_GT(without.between(first_, first_)(0, 0), 1e5 * before(0, 0));
  EXPECT_NEAR(without.between(first_, first_)(1, 1), before(1, 1), 1e-9);
  for (const double* block : {first_, second_}) EXPECT_TRUE(isCovariance(without.between(block, block)));
  // A correlated coordinate becomes uncertain as well.
  EXPECT_GT(without.between(second_, second_)(0, 0), 10.0 * before(3, 3));
}

}  // namespace
}  // namespace lodeline
