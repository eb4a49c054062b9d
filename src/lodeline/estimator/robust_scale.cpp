#include "lodeline/estimator/robust_scale.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace lodeline {

namespace {

constexpr double kLn2 = std::numbers::ln2, kLn10 = std::numbers::ln10;
// 2 / nu. Lighter tails count as normal, heavier ones as this: a still narrower loss finds wrong minima where
// many points slide (robust_scale_test.cpp).
constexpr double kNormalTail = 2.0 / 9.3, kHeaviestTail = 2.0 / 4.0;

double quantile(double share, std::vector<double>* values) {
  const auto at = values->begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values->size()));
  std::nth_element(values->begin(), at, values->end());
  return *at;
}

/// 2 / nu of the t distribution whose 90 % quantile is `ratio` medians.
double tailOf(double ratio) {
  const auto ratioOf = [](double tail) {
    return std::sqrt(std::expm1(tail * kLn10) / std::expm1(tail * kLn2));
  };
  double least = kNormalTail, most = kHeaviestTail;
  if (ratio <= ratioOf(least)) return least;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (least + most);
    (ratioOf(middle) < ratio ? least : most) = middle;
  }
  return most;
}

}  // namespace

std::optional<double> robustScale(std::vector<double> errors_sigmas, const SolverOptions& options) {
  constexpr size_t kEnough = 20;
  // Images without noise must not end in a loss that rejects everything.
  constexpr double kLeast_sigmas = 0.05;
  if (errors_sigmas.size() < kEnough) return std::nullopt;
  const double median = quantile(0.5, &errors_sigmas);
  const double ratio = quantile(0.9, &errors_sigmas) / std::max(median, 1e-9);
  const double narrowing = std::sqrt(std::expm1(kNormalTail * kLn2) / std::expm1(tailOf(ratio) * kLn2));
  const double wanted = std::max(narrowing * options.robust_scale_medians * median, kLeast_sigmas);
  return std::min(wanted, options.robust_scale_sigmas);
}

void adaptRobustScales(Window& window, FrameErrors errors_sigmas, const SolverOptions& options) {
  for (auto& [id, errors] : errors_sigmas) {
    const auto scale = robustScale(std::move(errors), options);
    if (scale) window.find(id)->robust_scale_sigmas = *scale;
  }
}

}  // namespace lodeline
