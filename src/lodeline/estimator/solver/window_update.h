#pragma once

#include "lodeline/estimator/solver/levenberg_marquardt.h"
#include "lodeline/estimator/visual/landmark_linearization_cache.h"
#include "lodeline/problem/covariance.h"
#include "lodeline/problem/window_terms.h"

namespace lodeline {

struct WindowUpdate {
  SolveSummary summary;
  /// As from jointCovariance(), with the Jacobians of the last step.
  JointCovariance covariance;
  /// Residual norms of all but the frozen landmarks of the updated window, see ReprojectionSystem::errors().
  std::vector<double> errors_sigmas;
};

/// Minimizes the cost over all variables of the window with minimize(). The normal equations use PriorTerms
/// and ReprojectionSystem in place of the factors. This takes a fraction of the time of a general solver, and
/// also gives the covariance. It updates poses, motions and landmarks of the window in place, except for
/// frozen landmarks. On one thread, so that the same input gives the same bytes.
WindowUpdate updateWindow(Window& window, const Prior& prior, const FactorBuilder& factors,
                          const SolveLimits& limits,
                          const LandmarkLinearizationCache& frozen = LandmarkLinearizationCache(0));

}  // namespace lodeline
