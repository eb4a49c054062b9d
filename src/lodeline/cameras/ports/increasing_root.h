#pragma once

#include <cmath>
#include <optional>

namespace lodeline {

/// Value of a function with its derivative.
struct ValueAndSlope {
  double value = 0.0, slope = 0.0;
};

/// Root of an increasing function between `low` and `high` from a start within, to 1e-14 relative. Newton's
/// method: its steps stay between the arguments that are known to be too small and too large. A step that
/// would leave them goes to their middle instead, or doubles the argument where no upper one is known.
/// Returns nothing where no root is found.
template <typename Function>
std::optional<double> increasingRoot(const Function& function, double low, double start, double high) {
  constexpr int kMaxSteps = 200;
  // The error after a step of Newton's method is of the order of the square of the step.
  constexpr double kLastNewtonStep = 1e-7, kLastBisection = 1e-15;
  double x = start;
  for (int i = 0; i < kMaxSteps; ++i) {
    const ValueAndSlope at = function(x);
    if (!std::isfinite(at.value)) return std::nullopt;
    if (at.value == 0.0) return x;
    (at.value < 0.0 ? low : high) = x;
    double next = x - at.value / at.slope;
    const bool is_within = next >= low && next <= high;
    if (!is_within) next = std::isfinite(high) ? 0.5 * (low + high) : 2.0 * low + 1.0;
    const double step = std::abs(next - x);
    x = next;
    if (step <= (is_within ? kLastNewtonStep : kLastBisection) * std::abs(x)) return x;
  }
  return std::nullopt;
}

}  // namespace lodeline
