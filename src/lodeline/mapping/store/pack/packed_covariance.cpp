#include "lodeline/mapping/store/pack/packed_covariance.h"

#include <fmt/format.h>

#include <cmath>

namespace lodeline {
namespace {

/// Difference of an element from that of a covariance over the two standard deviations, from rounding.
constexpr double kRounding = 1e-6;

/// Cholesky factor with a zero column where a pivot vanishes, as in the covariance of a fixed first pose.
template <int N>
Eigen::Matrix<double, N, N> semiDefiniteFactor(const Eigen::Matrix<double, N, N>& covariance) {
  Eigen::Matrix<double, N, N> factor = Eigen::Matrix<double, N, N>::Zero();
  for (int j = 0; j < N; ++j) {
    const double pivot = covariance(j, j) - factor.row(j).head(j).squaredNorm();
    if (pivot <= kRounding * kRounding * covariance(j, j)) continue;
    factor(j, j) = std::sqrt(pivot);
    for (int i = j + 1; i < N; ++i)
      factor(i, j) = (covariance(i, j) - factor.row(i).head(j).dot(factor.row(j).head(j))) / factor(j, j);
  }
  return factor;
}

}  // namespace

template <int N>
Bytes packCovariance(const Eigen::Matrix<double, N, N>& covariance) {
  if (!covariance.allFinite()) throw InputError("a covariance is not finite");
  if (covariance.diagonal().minCoeff() < 0.0) throw InputError("a variance is negative");
  const Eigen::Matrix<double, N, N> factor = semiDefiniteFactor<N>(covariance);
  const Eigen::Matrix<double, N, N> error = factor * factor.transpose() - covariance;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      if (std::abs(error(i, j)) > kRounding * std::sqrt(covariance(i, i) * covariance(j, j)))
        throw InputError(
            fmt::format("a covariance is not symmetric and positive semi-definite ({}, {})", i, j));
    }
  }
  ByteWriter writer;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) {
      if (std::abs(factor(i, j)) > 1e30) throw InputError("a covariance is too large");
      writer.real32(factor(i, j));
    }
  }
  return writer.bytes();
}

template <int N>
Eigen::Matrix<double, N, N> unpackCovariance(std::span<const unsigned char> bytes) {
  constexpr size_t kLength = sizeof(float) * N * (N + 1) / 2;
  if (bytes.size() != kLength)
    throw InputError(fmt::format("a covariance has {} bytes, not {}", bytes.size(), kLength));
  ByteReader reader(bytes);
  Eigen::Matrix<double, N, N> factor = Eigen::Matrix<double, N, N>::Zero();
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j <= i; ++j) factor(i, j) = reader.real32();
  }
  if (!factor.allFinite()) throw InputError("a covariance is not finite");
  return factor * factor.transpose();
}

template Bytes packCovariance<3>(const Mat3&);
template Bytes packCovariance<6>(const Mat6&);
template Mat3 unpackCovariance<3>(std::span<const unsigned char>);
template Mat6 unpackCovariance<6>(std::span<const unsigned char>);

}  // namespace lodeline
