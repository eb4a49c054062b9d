#pragma once

#include <algorithm>
#include <cmath>

namespace lodeline {

struct SolveLimits {
  int max_iterations = 4;
  double relative_gain =
      1e-4;  ///< iterations end after a step that reduces the cost by less than this share...
  double absolute_gain = 0.0;  ///< ...or by less than this, whichever is larger
};

struct SolveSummary {
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  bool usable = true;      ///< false where the cost is not finite
  bool converged = false;  ///< before the limit of iterations
};

/// Minimizes a cost by damped Gauss-Newton steps (Levenberg-Marquardt). A step solves
///   (H + damping diag(H)) d = -g
/// at the present values, with Gauss-Newton Hessian H and gradient g. The first step is undamped. A step that
/// does not reduce the cost is taken back and tried with more damping; the iterations end when no damping
/// helps. So the cost never increases. After darkness a window as a whole is known to metres, and its frames
/// relative to each other to micrometres. Any damping that is small relative to the latter would hold the
/// whole window at its dead-reckoning position; hence the undamped steps.
///
/// Problem has
///   double cost();               at the present values
///   void linearize();            computes H and g at the present values, and keeps the values for restore()
///   bool step(double damping);   changes the values by the step; false, without a change, where the damped H
///                                is not positive definite
///   void restore();              sets the values of the last linearize()
template <typename Problem>
SolveSummary minimize(Problem& problem, const SolveLimits& limits) {
  constexpr double kLeastDamping = 1e-9, kMostDamping = 1e3;
  constexpr double kLess = 0.01, kMore = 100.0;
  SolveSummary summary;
  double cost = summary.initial_cost = problem.cost();
  double damping = 0.0;
  while (summary.iterations < limits.max_iterations && !summary.converged) {
    ++summary.iterations;
    problem.linearize();
    double gain = 0.0;
    while (!(gain > 0.0) && damping <= kMostDamping) {
      if (problem.step(damping)) {
        gain = cost - problem.cost();
        if (!(gain > 0.0)) problem.restore();
      }
      damping = gain > 0.0 ? kLess * damping : std::max(kLeastDamping, kMore * damping);
    }
    if (damping < kLeastDamping) damping = 0.0;
    summary.converged = !(gain > std::max(limits.relative_gain * cost, limits.absolute_gain));
    if (gain > 0.0) cost -= gain;
  }
  summary.final_cost = cost;
  summary.usable = std::isfinite(cost);
  return summary;
}

}  // namespace lodeline
