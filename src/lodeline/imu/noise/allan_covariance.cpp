#include "lodeline/imu/noise/allan_covariance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lodeline {
namespace {

using KindValues = std::array<double, kRandomKinds>;

/// Ratio of averaging times beyond which estimates are nearly independent.
constexpr double kCorrelatedRatio = 40.0;
constexpr std::array<double, 3> kSecondDifference = {1.0, -2.0, 1.0};

/// Autocovariance of the integrated noise at a lag, for coefficient 1, up to polynomials that second
/// differences remove. Quantization is white in the integral, so its autocovariance is zero except at lag
/// zero.
KindValues integralAutocovariance(double lag_s, double interval_s) {
  const double t = std::abs(lag_s);
  const bool is_zero = t < 0.5 * interval_s;
  return {is_zero ? 1.0 : 0.0, -0.5 * t, is_zero ? 0.0 : t * t * std::log(t) / (2.0 * std::numbers::pi),
          t * t * t / 12.0};
}

/// Covariance of the second difference over `first_s` at time 0 with that over `second_s` at time `lag_s`.
KindValues differenceCovariance(double first_s, double second_s, double lag_s, double interval_s) {
  KindValues sum{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const KindValues value = integralAutocovariance(lag_s + j * second_s - i * first_s, interval_s);
      for (size_t kind = 0; kind < sum.size(); ++kind) {
        sum[kind] += kSecondDifference[static_cast<size_t>(i)] * kSecondDifference[static_cast<size_t>(j)] *
                     value[kind];
      }
    }
  }
  return sum;
}

}  // namespace

std::array<double, kNoiseKinds> unitAllanVariance(double tau_s) {
  return {3.0 / (tau_s * tau_s), 1.0 / tau_s, 2.0 * std::numbers::ln2 / std::numbers::pi, tau_s / 3.0,
          tau_s * tau_s / 2.0};
}

double flickerShare(double tau_s, double corner_s) {
  if (corner_s <= 0.0) return 1.0;
  // Allan variance of a Gauss-Markov process of variance 1 and time constant T (IEEE 952-1997, annex C),
  // summed over equal steps of log T. With variance dT/T per step, the full sum is 2 ln2.
  constexpr double kStep = 0.1;
  double sum = 0.0;
  for (double log_ratio = 0.5 * kStep; log_ratio < 40.0; log_ratio += kStep) {
    const double x = tau_s / (corner_s * std::exp(log_ratio));
    // The closed form is inaccurate for small x; 2x/3 is the first term of its series.
    if (x < 1e-3) {
      sum += 2.0 / 3.0 * x;
      continue;
    }
    sum += 2.0 / x * (1.0 - (3.0 - 4.0 * std::exp(-x) + std::exp(-2.0 * x)) / (2.0 * x));
  }
  return sum * kStep / (2.0 * std::numbers::ln2);
}

AllanCovariance::AllanCovariance(const std::vector<AllanPoint>& points, double interval_s,
                                 double duration_s) {
  const auto size = static_cast<Eigen::Index>(points.size());
  for (auto& row : pairs_) row.fill(Eigen::MatrixXd::Zero(size, size));
  for (int i = 0; i < size; ++i) {
    for (int j = i; j < size; ++j) {
      const AllanPoint& shorter = points[static_cast<size_t>(i)];
      const AllanPoint& longer = points[static_cast<size_t>(j)];
      if (longer.tau_s > kCorrelatedRatio * shorter.tau_s) continue;
      fill(i, j, shorter, longer, interval_s, duration_s);
    }
  }
}

void AllanCovariance::fill(int row, int column, const AllanPoint& shorter, const AllanPoint& longer,
                           double interval_s, double duration_s) {
  const double first_s = shorter.tau_s, second_s = longer.tau_s;
  const double step_s = static_cast<double>(shorter.stride) * interval_s;
  const double first_span_s = std::max(step_s, duration_s - 2.0 * first_s);
  const double second_span_s = std::max(step_s, duration_s - 2.0 * second_s);
  // Covariances of white noise and random walk vanish when the differences do not overlap; that of flicker
  // noise decays quickly.
  const double reach_s = 3.0 * (first_s + second_s);
  const auto steps = static_cast<int64_t>(reach_s / step_s);
  std::array<std::array<double, kRandomKinds>, kRandomKinds> sums{};
  for (int64_t step = -steps; step <= steps; ++step) {
    const double lag_s = static_cast<double>(step) * step_s;
    const double overlap_s =
        std::min(first_span_s, second_span_s - lag_s) - std::max(0.0, -lag_s);  // moments with a partner
    if (overlap_s <= 0.0) continue;
    const KindValues c = differenceCovariance(first_s, second_s, lag_s, interval_s);
    for (size_t a = 0; a < kRandomKinds; ++a) {
      for (size_t b = a; b < kRandomKinds; ++b) sums[a][b] += overlap_s * c[a] * c[b];
    }
  }
  const double scale =
      step_s / (2.0 * first_s * first_s * second_s * second_s * first_span_s * second_span_s);
  for (size_t a = 0; a < kRandomKinds; ++a) {
    for (size_t b = a; b < kRandomKinds; ++b) {
      const double value = scale * sums[a][b] * (a == b ? 1.0 : 2.0);
      pairs_[a][b](row, column) = value;
      pairs_[a][b](column, row) = value;
    }
  }
}

Eigen::MatrixXd AllanCovariance::operator()(const std::array<double, kRandomKinds>& squared) const {
  Eigen::MatrixXd covariance = 0.0 * pairs_[0][0];
  for (size_t a = 0; a < kRandomKinds; ++a) {
    for (size_t b = a; b < kRandomKinds; ++b) covariance += squared[a] * squared[b] * pairs_[a][b];
  }
  return covariance;
}

}  // namespace lodeline
