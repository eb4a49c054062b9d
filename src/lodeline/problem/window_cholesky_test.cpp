#include "lodeline/problem/window_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>

#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/problem/window_terms.h"

namespace lodeline {
namespace {

class WindowCholeskyTest : public testing::Test {
 protected:
  WindowCholeskyTest() {
    const Prior prior = test_.fill();
    system_ = linearize(collectTerms(test_.window, prior, test_.factors));
    const Frame& newest = test_.window.newest();
    last_ = {newest.pose.data(), newest.motion.data()};
  }

  // Inverse of the damped system by a dense factorization without any ordering.
  Eigen::MatrixXd inverse(double damping) const {
    const Eigen::MatrixXd h = system_.hessian();
    const Eigen::VectorXd scale = h.diagonal().cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd scaled = scale.asDiagonal() * h * scale.asDiagonal();
    scaled.diagonal().array() += damping;
    return scale.asDiagonal() * scaled.fullPivLu().inverse() * scale.asDiagonal();
  }

  void expectRight(const std::vector<const double*>& first) const {
    constexpr double kDamping = 1e-3;
    WindowCholesky cholesky(system_, first, last_);
    ASSERT_TRUE(cholesky.factorize(kDamping));
    const Eigen::MatrixXd expected = inverse(kDamping);
    const Eigen::VectorXd x = cholesky.solve(system_.gradient());
    EXPECT_LT((x - expected * system_.gradient()).norm(), 1e-9 * x.norm());
    const Eigen::MatrixXd covariance = cholesky.covarianceOfLast();
    ASSERT_EQ(covariance.rows(), kPoseTangentSize + kMotionSize);
    const int row = system_.find(last_[0])->offset;
    const int column = system_.find(last_[1])->offset;
    const auto cross = expected.block(row, column, kPoseTangentSize, kMotionSize);
    EXPECT_LT((covariance.topRightCorner(kPoseTangentSize, kMotionSize) - cross).norm(), 1e-9 * cross.norm());
    EXPECT_EQ(covariance, covariance.transpose());
  }

  TestWindow test_;
  NormalEquations system_;
  std::vector<const double*> last_;
};

TEST_F(WindowCholeskyTest, EqualsADenseFactorWithMotionsFirst) {
  const std::vector<const double*> motions = motionsButTheNewest(test_.window);
  ASSERT_EQ(motions.size() + 1, test_.window.frames().size());
  expectRight(motions);
}

TEST_F(WindowCholeskyTest, IsRightInAnyOrder) {
  expectRight({});
  std::vector<const double*> motions = motionsButTheNewest(test_.window);
  std::reverse(motions.begin(), motions.end());
  expectRight(motions);
  expectRight({test_.window.frames()[2]->pose.data(), motions[0], test_.window.frames()[0]->pose.data()});
}

TEST_F(WindowCholeskyTest, RefusesWhatIsNotPositiveDefinite) {
  for (const bool in_first : {true, false}) {
    NormalEquations spoilt = system_;
    const double* value = in_first ? test_.window.frames()[1]->motion.data() : last_[0];
    const NormalEquations::Block block = *spoilt.find(value);
    spoilt.add({{block.value, block.ambient_size, 0}},
               -1e12 * Eigen::MatrixXd::Identity(block.tangentSize(), block.tangentSize()),
               Eigen::VectorXd::Zero(block.tangentSize()));
    EXPECT_FALSE(WindowCholesky(spoilt, motionsButTheNewest(test_.window), last_).factorize(0.0));
  }
}

}  // namespace
}  // namespace lodeline
