#include "lodeline/estimator/known_waters.h"

#include <array>
#include <cmath>
#include <numbers>

namespace lodeline {
namespace {

struct Water {
  double share;
  Belief ratio;
};

constexpr std::array<Water, 3> kWaters{
    {{0.4, {1.0, kOneWaterSigma}}, {0.25, {0.975, kOneWaterSigma}}, {0.15, {1.025, kOneWaterSigma}}}};
constexpr double kShareOfTheRest = 0.2;
constexpr double kRangeOfTheRest = 0.08;

}  // namespace

Belief amongKnownWaters(const Belief& seen) {
  // Moments about what was seen: it may be known to many digits.
  double sum = kShareOfTheRest / kRangeOfTheRest;
  double first = 0.0;
  double second = sum * seen.sigma * seen.sigma;
  for (const Water& water : kWaters) {
    const double sigma = std::hypot(seen.sigma, water.ratio.sigma);
    const double distance = (seen.value - water.ratio.value) / sigma;
    const double weight =
        water.share * std::exp(-0.5 * distance * distance) / (std::sqrt(2.0 * std::numbers::pi) * sigma);
    const Belief here = product(seen, water.ratio);
    const double moved = here.value - seen.value;
    sum += weight;
    first += weight * moved;
    second += weight * (moved * moved + here.sigma * here.sigma);
  }
  const double moved = first / sum;
  return {seen.value + moved, std::sqrt(second / sum - moved * moved)};
}

}  // namespace lodeline
