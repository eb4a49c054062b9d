#pragma once

#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/solver/levenberg_marquardt.h"

namespace lodeline {

/// Minimizes the cost over all variables of the window with Ceres: an independent solver that tests compare
/// updateWindow() with. It uses one thread.
SolveSummary solveWithCeres(Window& window, const Prior& prior, const FactorBuilder& factors,
                            const SolveLimits& limits);

}  // namespace lodeline
