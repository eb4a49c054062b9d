#pragma once

#include <optional>

#include "lodeline/problem/state/parameter_block.h"

namespace lodeline {

/// Sigma of the density ratio among waters and gauges of one kind, including the variation of gravity.
constexpr double kOneWaterSigma = 0.004;

/// Posterior of the density ratio (water over the density that a gauge assumes) for the measured ratio
/// `seen`. Water is mostly fresh (997 to 1000 kg/m^3) or salt (1020 to 1030), and gauges are set to 1000,
/// 1020 (EN 13319) or 1025 to 1030. Most ratios are therefore near 1, 0.975 and 1.025. Brackish water, a
/// halocline on the way and a gauge with a wrong scale can have any ratio nearby. The prior is a mixture
/// of normals and a constant; `seen.sigma` must be positive.
ScalarPrior amongWaterDensities(const ScalarPrior& seen);

/// The normal likelihood whose product with `seen` is `known` (moment matching, as in expectation
/// propagation: Minka 2001). Empty where `known` is not more accurate than `seen`, as between two waters.
std::optional<ScalarPrior> likelihoodBetween(const ScalarPrior& seen, const ScalarPrior& known);

/// The estimate whose product with `likelihood` is `known`; empty where the likelihood is all the
/// information.
std::optional<ScalarPrior> without(const ScalarPrior& likelihood, const ScalarPrior& known);

}  // namespace lodeline
