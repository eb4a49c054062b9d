#pragma once

#include <Eigen/Core>

namespace lodeline {

/// c -= a b^T, with a of m x k, b of n x k, c of m x n elements. Sums run over k in order, the same for AVX2
/// and for any machine. Eigen's own product is compiled for what all machines have, half as wide.
void subtractProduct(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b,
                     Eigen::Ref<Eigen::MatrixXd> c);

/// The lower triangle of c -= a a^T; what stands above the diagonal means nothing afterwards.
void subtractSquare(const Eigen::Ref<const Eigen::MatrixXd>& a, Eigen::Ref<Eigen::MatrixXd> c);

}  // namespace lodeline
