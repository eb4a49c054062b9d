#include "lodeline/estimator/wide_products.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

/// Of a size that fills no tile whole, a part of a larger matrix, as the estimator hands them over.
class WideProducts : public testing::TestWithParam<std::tuple<int, int>> {
 protected:
  const int m_ = std::get<0>(GetParam()), n_ = std::get<1>(GetParam());
  static constexpr int kDepth = 7;
  const Eigen::MatrixXd a_ = Eigen::MatrixXd::Random(m_ + 3, kDepth + 1);
  const Eigen::MatrixXd b_ = Eigen::MatrixXd::Random(n_ + 5, kDepth + 2);
  const Eigen::MatrixXd c_ = Eigen::MatrixXd::Random(m_ + 4, m_ + n_);
};

TEST_P(WideProducts, AreThoseOfEigenAndLeaveTheRestAlone) {
  Eigen::MatrixXd expected = c_, c = c_;
  const auto a = a_.block(1, 1, m_, kDepth), b = b_.block(2, 0, n_, kDepth);
  expected.block(2, 1, m_, n_) -= a * b.transpose();
  subtractProduct(a, b, c.block(2, 1, m_, n_));
  EXPECT_LT((c - expected).cwiseAbs().maxCoeff(), 1e-14);
}

TEST_P(WideProducts, OfAMatrixWithItselfGiveItsLowerTriangle) {
  Eigen::MatrixXd expected = c_, c = c_;
  const auto a = a_.block(1, 1, m_, kDepth);
  expected.block(2, 1, m_, m_) -= a * a.transpose();
  subtractSquare(a, c.block(2, 1, m_, m_));
  const Eigen::MatrixXd difference = c - expected;
  const Eigen::MatrixXd triangle = difference.block(2, 1, m_, m_).triangularView<Eigen::Lower>();
  EXPECT_EQ(triangle.rows(), m_);
  EXPECT_LT(triangle.cwiseAbs().sum(), 1e-12);
  EXPECT_EQ(difference.topRows(2).cwiseAbs().sum(), 0.0);
  EXPECT_EQ(difference.bottomRows(2).cwiseAbs().sum(), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Sizes, WideProducts,
                         testing::Combine(testing::Values(0, 1, 3, 4, 6, 9, 14, 24),
                                          testing::Values(0, 1, 5, 6, 7, 12, 15)));

}  // namespace
}  // namespace lodeline
