#pragma once

#include "lodeline/estimator/problem/factor_builder.h"

namespace lodeline {

struct SolveSummary {
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  bool usable = true;      ///< false where the solver failed and the window was left as it was
  bool converged = false;  ///< before the limit of iterations
};

/// Minimizes the cost over all variables of the window: Levenberg-Marquardt with landmarks eliminated first,
/// on one thread, so that the same input gives the same bytes. First, inertial terms whose biases have
/// changed too much are integrated again.
struct SolveLimits {
  int max_iterations = 4;
  double function_tolerance = 1e-4;  ///< relative change of the cost that ends the iterations
};
SolveSummary solveWindow(Window& window, const Prior& prior, const FactorBuilder& factors,
                         const SolveLimits& limits);

}  // namespace lodeline
