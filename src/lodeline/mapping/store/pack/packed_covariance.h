#pragma once

#include <span>

#include "lodeline/mapping/store/pack/packed_bytes.h"
#include "lodeline/types.h"

namespace lodeline {

/// A covariance of N coordinates (3 or 6) as the lower triangle of its Cholesky factor L, row by row, in
/// float32: N (N + 1) / 2 numbers. The product L L^T is positive semi-definite whatever the rounding. Throws
/// InputError where the matrix is not finite, not symmetric or not positive semi-definite (to 1e-6 of the
/// standard deviations).
template <int N>
Bytes packCovariance(const Eigen::Matrix<double, N, N>& covariance);

/// Throws InputError where the length is wrong or a number is not finite.
template <int N>
Eigen::Matrix<double, N, N> unpackCovariance(std::span<const unsigned char> bytes);

extern template Bytes packCovariance<3>(const Mat3&);
extern template Bytes packCovariance<6>(const Mat6&);
extern template Mat3 unpackCovariance<3>(std::span<const unsigned char>);
extern template Mat6 unpackCovariance<6>(std::span<const unsigned char>);

}  // namespace lodeline
