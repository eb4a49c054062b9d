#include "lodeline/problem/simd_gemm.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lodeline {
namespace {

constexpr int kDepth = 7;
constexpr int kSizes[] = {0, 1, 3, 4, 6, 9, 14, 24};

/// Blocks of larger matrices, as in the estimator.
struct Operands {
  int m, n;
  Eigen::MatrixXd a = Eigen::MatrixXd::Random(m + 3, kDepth + 1);
  Eigen::MatrixXd b = Eigen::MatrixXd::Random(n + 5, kDepth + 2);
  Eigen::MatrixXd c = Eigen::MatrixXd::Random(m + 4, std::max(m, n) + 2);
};

TEST(WideProducts, AreThoseOfEigenAndLeaveTheRestAlone) {
  for (const int m : kSizes) {
    for (const int n : {0, 1, 5, 6, 7, 12, 15}) {
      const Operands o{m, n};
      Eigen::MatrixXd expected = o.c, c = o.c;
      const auto a = o.a.block(1, 1, m, kDepth), b = o.b.block(2, 0, n, kDepth);
      expected.block(2, 1, m, n) -= a * b.transpose();
      subtractProduct(a, b, c.block(2, 1, m, n));
      EXPECT_LT((c - expected).cwiseAbs().maxCoeff(), 1e-14) << m << " x " << n;
    }
  }
}

TEST(WideProducts, OfAMatrixWithItselfGiveItsLowerTriangle) {
  for (const int m : kSizes) {
    const Operands o{m, m};
    Eigen::MatrixXd expected = o.c, c = o.c;
    const auto a = o.a.block(1, 1, m, kDepth);
    expected.block(2, 1, m, m) -= a * a.transpose();
    subtractSquare(a, c.block(2, 1, m, m));
    // Entries above the diagonal are undefined.
    for (auto* matrix : {&c, &expected})
      matrix->block(2, 1, m, m).triangularView<Eigen::StrictlyUpper>().setZero();
    EXPECT_LT((c - expected).cwiseAbs().maxCoeff(), 1e-14) << m;
  }
}

}  // namespace
}  // namespace lodeline
