#pragma once

#include "lodeline/estimator/problem/covariance.h"
#include "lodeline/estimator/problem/window_terms.h"
#include "lodeline/estimator/solver/window_solver.h"
#include "lodeline/estimator/visual/landmark_linearization_cache.h"

namespace lodeline {

struct WindowUpdate {
  SolveSummary summary;
  /// As from jointCovariance(), with the Jacobians that the last step was made from.
  JointCovariance covariance;
  /// Of all but the frozen landmarks of the window as it is now, see ReprojectionSystem::errors().
  std::vector<double> errors_sigmas;
};

/// The quick counterpart of solveWindow(): the same cost, but Levenberg-Marquardt steps on normal equations
/// that are set up here, with PriorTerms and ReprojectionSystem in place of their factors. It takes a
/// fraction of the time of a general solver, and the covariance comes with it. Poses, motions and landmarks
/// of the window are moved in place, but for the landmarks that are frozen.
WindowUpdate updateWindow(Window& window, const Prior& prior, const FactorBuilder& factors,
                          const SolveLimits& limits,
                          const LandmarkLinearizationCache& frozen = LandmarkLinearizationCache(0));

}  // namespace lodeline
