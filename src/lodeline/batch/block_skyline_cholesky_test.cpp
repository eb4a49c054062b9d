#include "lodeline/batch/block_skyline_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "simulation/shared/random.h"

namespace lodeline {
namespace {

/// A chain in which each block is coupled to the two before it, and a border coupled to all.
struct Example {
  BlockSkylineCholesky skyline{{2, 3, 1, 4, 2, 3}, {0, 0, 0, 1, 2, 0}};
  Eigen::MatrixXd dense;

  Example() {
    Random random(3, "skyline");
    skyline.setZero();
    dense = Eigen::MatrixXd::Zero(skyline.size(), skyline.size());
    const int first[] = {0, 0, 0, 1, 2, 0};
    for (int row = 0; row < skyline.blocks(); ++row) {
      for (int column = first[row]; column <= row; ++column) {
        Eigen::MatrixXd entry = Eigen::MatrixXd::NullaryExpr(
            skyline.blockSize(row), skyline.blockSize(column), [&]() { return random.normal(); });
        if (row == column) {
          entry = Eigen::MatrixXd(entry * entry.transpose());
          entry.diagonal().array() += 20.0;
        }
        skyline.block(row, column) = entry;
        dense.block(skyline.offset(row), skyline.offset(column), entry.rows(), entry.cols()) = entry;
        dense.block(skyline.offset(column), skyline.offset(row), entry.cols(), entry.rows()) =
            entry.transpose();
      }
    }
  }
};

TEST(BlockSkylineCholesky, SolvesAsADenseMatrixDoes) {
  Example example;
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(example.skyline.size(), -1.0, 2.0);
  ASSERT_TRUE(example.skyline.factorize());
  EXPECT_LT((example.dense * example.skyline.solve(b) - b).norm(), 1e-12);
}

TEST(BlockSkylineCholesky, InverseWithinTheSkylineIsThatOfTheWholeMatrix) {
  Example example;
  const Eigen::MatrixXd inverse = example.dense.inverse();
  ASSERT_TRUE(example.skyline.factorize());
  example.skyline.invert();
  const BlockSkylineCholesky& skyline = example.skyline;
  for (const auto& [row, column] : {std::pair(0, 0), {1, 0}, {3, 1}, {4, 3}, {5, 0}, {5, 4}, {5, 5}}) {
    const Eigen::MatrixXd expected = inverse.block(skyline.offset(row), skyline.offset(column),
                                                   skyline.blockSize(row), skyline.blockSize(column));
    EXPECT_LT((skyline.block(row, column) - expected).norm(), 1e-12) << row << ' ' << column;
  }
}

TEST(BlockSkylineCholesky, DampingGrowsTheDiagonalAlone) {
  Example example;
  const Eigen::MatrixXd before = example.skyline.block(5, 5), aside = example.skyline.block(5, 1);
  example.skyline.damp(0.5);
  EXPECT_NEAR(example.skyline.block(5, 5)(1, 1), 1.5 * before(1, 1), 1e-12);
  EXPECT_EQ(example.skyline.block(5, 5)(1, 0), before(1, 0));
  EXPECT_EQ(aside, example.skyline.block(5, 1));
}

TEST(BlockSkylineCholesky, RefusesWhatIsNotPositiveDefinite) {
  Example example;
  example.skyline.block(3, 3).diagonal().array() -= 100.0;
  EXPECT_FALSE(example.skyline.factorize());
}

}  // namespace
}  // namespace lodeline
