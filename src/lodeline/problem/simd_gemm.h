#pragma once

#include <Eigen/Core>

namespace lodeline {

/// Computes c -= a b^T, with a of m x k, b of n x k, c of m x n elements. Sums run over k in order, with the
/// same result for AVX2 and any other machine. Eigen's own product is compiled for the instruction set of all
/// machines, with vectors half as wide.
void subtractProduct(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b,
                     Eigen::Ref<Eigen::MatrixXd> c);

/// Computes the lower triangle of c -= a a^T; entries above the diagonal are undefined afterwards.
void subtractSquare(const Eigen::Ref<const Eigen::MatrixXd>& a, Eigen::Ref<Eigen::MatrixXd> c);

}  // namespace lodeline
