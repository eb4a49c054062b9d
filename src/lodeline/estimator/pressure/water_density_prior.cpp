#include "lodeline/estimator/pressure/water_density_prior.h"

#include <array>
#include <cmath>
#include <numbers>

namespace lodeline {
namespace {

struct Water {
  double share;
  ScalarPrior ratio;
};

constexpr std::array<Water, 3> kWaters{
    {{0.4, {1.0, kOneWaterSigma}}, {0.25, {0.975, kOneWaterSigma}}, {0.15, {1.025, kOneWaterSigma}}}};
constexpr double kShareOfTheRest = 0.2;
constexpr double kRangeOfTheRest = 0.08;

double informationOf(const ScalarPrior& ratio) { return 1.0 / (ratio.sigma * ratio.sigma); }

/// Product of two normal distributions.
ScalarPrior product(const ScalarPrior& a, const ScalarPrior& b) {
  const double information = informationOf(a) + informationOf(b);
  return {(a.value * informationOf(a) + b.value * informationOf(b)) / information,
          1.0 / std::sqrt(information)};
}

/// The normal distribution whose product with `part` is `whole`, where it exists.
std::optional<ScalarPrior> quotient(const ScalarPrior& whole, const ScalarPrior& part) {
  constexpr double kLeast = 1e-3;  // of the information of `whole`: less is rounding
  const double information = informationOf(whole) - informationOf(part);
  if (!(information > kLeast * informationOf(whole))) return std::nullopt;
  return ScalarPrior{(whole.value * informationOf(whole) - part.value * informationOf(part)) / information,
                     1.0 / std::sqrt(information)};
}

}  // namespace

ScalarPrior amongWaterDensities(const ScalarPrior& seen) {
  // Moments relative to the measured value, which may be known to many digits.
  double sum = kShareOfTheRest / kRangeOfTheRest;
  double first = 0.0;
  double second = sum * seen.sigma * seen.sigma;
  for (const Water& water : kWaters) {
    const double sigma = std::hypot(seen.sigma, water.ratio.sigma);
    const double distance = (seen.value - water.ratio.value) / sigma;
    const double weight =
        water.share * std::exp(-0.5 * distance * distance) / (std::sqrt(2.0 * std::numbers::pi) * sigma);
    const ScalarPrior here = product(seen, water.ratio);
    const double moved = here.value - seen.value;
    sum += weight;
    first += weight * moved;
    second += weight * (moved * moved + here.sigma * here.sigma);
  }
  const double moved = first / sum;
  return {seen.value + moved, std::sqrt(second / sum - moved * moved)};
}

std::optional<ScalarPrior> likelihoodBetween(const ScalarPrior& seen, const ScalarPrior& known) {
  return quotient(known, seen);
}

std::optional<ScalarPrior> without(const ScalarPrior& likelihood, const ScalarPrior& known) {
  return quotient(known, likelihood);
}

}  // namespace lodeline
