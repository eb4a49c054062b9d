#pragma once

#include "lodeline/estimator/covariance.h"
#include "lodeline/estimator/window_solver.h"
#include "lodeline/estimator/window_terms.h"

namespace lodeline {

struct WindowUpdate {
  SolveSummary summary;
  /// As from jointCovariance(), with the Jacobians that the last step was made from.
  JointCovariance covariance;
};

/// The per-frame counterpart of solveWindow(): the same terms, but a few Levenberg-Marquardt steps on normal
/// equations that are set up here, landmarks eliminated one by one. Next to a good prediction that is all
/// that is needed, and it takes less than half the time of a general solver, which has its own bookkeeping to
/// do; the covariance comes with it. Poses, motions and landmarks of the window are moved in place.
WindowUpdate updateWindow(Window& window, const Prior& prior, const FactorMaker& factors,
                          const SolveLimits& limits);

}  // namespace lodeline
