#pragma once

#include "lodeline/estimator/solver/levenberg_marquardt.h"
#include "lodeline/problem/factor_builder.h"

namespace lodeline {

/// Minimizes the cost over all variables of the window with Ceres, on one thread. It damps landmarks as well
/// as frames, which a start of one camera needs: its scale changes by factors on the way. Tests compare
/// updateWindow() with it.
SolveSummary solveWithCeres(Window& window, const Prior& prior, const FactorBuilder& factors,
                            const SolveLimits& limits);

}  // namespace lodeline
