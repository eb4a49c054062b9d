#pragma once

#include <limits>
#include <optional>

namespace lodeline {

/// A number as it is believed to be: a normal distribution.
struct Belief {
  double value = 0.0, sigma = 0.0;
};
constexpr Belief kNothingKnown{0.0, std::numeric_limits<double>::infinity()};

/// Of two normal distributions that both hold.
Belief product(const Belief& a, const Belief& b);

/// The normal likelihood that turns what was `seen` into what is `known` (moment matching, as in expectation
/// propagation: Minka 2001). Nothing where no more is known than was seen, as between two
/// things that it may be.
std::optional<Belief> likelihoodBetween(const Belief& seen, const Belief& known);

/// What was seen before `likelihood` turned it into `known`; nothing where the likelihood is all there is.
std::optional<Belief> without(const Belief& likelihood, const Belief& known);

}  // namespace lodeline
