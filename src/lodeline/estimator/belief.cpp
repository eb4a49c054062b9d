#include "lodeline/estimator/belief.h"

#include <cmath>

namespace lodeline {
namespace {

double informationOf(const Belief& belief) { return 1.0 / (belief.sigma * belief.sigma); }

/// The normal distribution that times `part` gives `whole`, where there is one.
std::optional<Belief> quotient(const Belief& whole, const Belief& part) {
  constexpr double kLeast = 1e-3;  // of the whole's information: less is rounding
  const double information = informationOf(whole) - informationOf(part);
  if (!(information > kLeast * informationOf(whole))) return std::nullopt;
  return Belief{(whole.value * informationOf(whole) - part.value * informationOf(part)) / information,
                1.0 / std::sqrt(information)};
}

}  // namespace

Belief product(const Belief& a, const Belief& b) {
  const double information = informationOf(a) + informationOf(b);
  return {(a.value * informationOf(a) + b.value * informationOf(b)) / information,
          1.0 / std::sqrt(information)};
}

std::optional<Belief> likelihoodBetween(const Belief& seen, const Belief& known) {
  return quotient(known, seen);
}

std::optional<Belief> without(const Belief& likelihood, const Belief& known) {
  return quotient(known, likelihood);
}

}  // namespace lodeline
