#include "lodeline/mapping/graph/robust/robust_weights.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

/// Factor by which mu rises in a step, as in the paper.
constexpr double kGraduation = 1.4;

}  // namespace

double chiSquaredQuantile(double probability, int degrees_of_freedom) {
  if (!(probability > 0.0 && probability < 1.0)) {
    throw UsageError("the probability of a chi-squared limit must lie between 0 and 1");
  }
  return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), probability);
}

GraduatedWeights::GraduatedWeights(const std::vector<double>& ratios) {
  const double largest = ratios.empty() ? 0.0 : *std::max_element(ratios.begin(), ratios.end());
  // The surrogate is convex over all residuals for mu = 1 / (2 q_max - 1). Where all residuals are within
  // the limit, the truncated cost itself is quadratic there.
  mu_ = largest > 1.0 ? 1.0 / (2.0 * largest - 1.0) : 1.0;
}

std::vector<double> GraduatedWeights::next(const std::vector<double>& ratios) {
  std::vector<double> weights;
  are_binary_ = true;
  for (const double ratio : ratios) {
    double weight = 1.0;
    if (!(ratio < (mu_ + 1.0) / mu_)) {
      weight = 0.0;
    } else if (ratio > mu_ / (mu_ + 1.0)) {
      weight = std::clamp(std::sqrt(mu_ * (mu_ + 1.0) / ratio) - mu_, 0.0, 1.0);
      are_binary_ = false;
    }
    weights.push_back(weight);
  }
  mu_ *= kGraduation;
  return weights;
}

}  // namespace lodeline
