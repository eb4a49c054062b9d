#pragma once

#include "lodeline/estimator/problem/covariance.h"
#include "lodeline/estimator/problem/window_terms.h"
#include "lodeline/estimator/solver/window_solver.h"
#include "lodeline/estimator/visual/landmark_linearization_cache.h"

namespace lodeline {

struct WindowUpdate {
  SolveSummary summary;
  /// As from jointCovariance(), with the Jacobians of the last step.
  JointCovariance covariance;
  /// Residual norms of all but the frozen landmarks of the updated window, see ReprojectionSystem::errors().
  std::vector<double> errors_sigmas;
};

/// Fast counterpart of solveWindow() for the same cost: Levenberg-Marquardt steps on normal equations that
/// use PriorTerms and ReprojectionSystem in place of the factors. It takes a fraction of the time of a
/// general solver, and also gives the covariance. It updates poses, motions and landmarks of the window in
/// place, except for frozen landmarks.
WindowUpdate updateWindow(Window& window, const Prior& prior, const FactorBuilder& factors,
                          const SolveLimits& limits,
                          const LandmarkLinearizationCache& frozen = LandmarkLinearizationCache(0));

}  // namespace lodeline
