#pragma once

#include <optional>

#include "lodeline/estimator/state/parameter_block.h"

namespace lodeline {

/// How far gauges and waters of a kind differ among one another, and gravity from one place to another.
constexpr double kOneWaterSigma = 0.004;

/// What is known of the density of the water over that which a depth gauge assumes, when it was seen to be
/// `seen`, given that water is mostly fresh (997 to 1000 kg/m^3) or salt (1020 to 1030) and gauges are set to
/// 1000, 1020 (EN 13319) or 1025 to 1030: most ratios lie about 1, 0.975 and 1.025. Brackish water, a
/// halocline on the way and a gauge with a scale of its own are the rest, which may be anything near. The
/// posterior of a mixture of normals and a constant; `seen.sigma` must be positive.
ScalarPrior amongWaterDensities(const ScalarPrior& seen);

/// The normal likelihood that turns what was `seen` into what is `known` (moment matching, as in expectation
/// propagation: Minka 2001). Nothing where no more is known than was seen, as between two waters.
std::optional<ScalarPrior> likelihoodBetween(const ScalarPrior& seen, const ScalarPrior& known);

/// What was seen before `likelihood` turned it into `known`; nothing where the likelihood is all there is.
std::optional<ScalarPrior> without(const ScalarPrior& likelihood, const ScalarPrior& known);

}  // namespace lodeline
