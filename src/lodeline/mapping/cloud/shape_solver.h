#pragma once

#include <vector>

#include "lodeline/mapping/cloud/shape_problem.h"

namespace lodeline {

/// Weight of a row by Geman and McClure's loss, (1 + (e / width)^2)^-2.
double shapeWeight(double error, double width);

/// Width of the loss at the end, in sigmas: 0.8 of the weight is left at one sigma.
constexpr double kShapeLossWidth = 3.0;

/// Offsets larger than this would need a curvature beyond that of a passage of 1 m radius: a chord of the
/// neighbourhood, 0.6 m, has a sagitta of 0.05 m there.
constexpr double kOffsetSigma_m = 0.05;

/// Robust least squares from one start.
struct ShapeFit {
  ShapeState state;
  /// Mean over the rows of min(e^2, 9), the cost by which places are compared; large without enough rows.
  double score = 1e9;
  double counterpart_share = 0.0;  ///< of the points that have a counterpart
  bool converged = false;
};

/// Minimizes the robust distances plus the prior by Gauss-Newton steps. The width of the loss starts at
/// `start_width_m` and shrinks to the noise (graduated non-convexity). Errors of points in one metre of wall
/// are not independent, so a row counts as a fifth of an observation beside the prior.
ShapeFit fitShape(const ShapeProblem& problem, const ShapePrior& prior, const ShapeState& start,
                  double start_width_m, size_t stride, int most_iterations);

/// Starts that cover the horizontal part of the prior to 2.5 sigma in steps of `spacing_m`. The other
/// parameters follow by their correlation. Empty where more than `most` would be needed.
std::vector<ShapeState> startsOf(const ShapeProblem& problem, const ShapePrior& prior, double spacing_m,
                                 size_t most);

/// Different minima from all starts, the lowest score first.
std::vector<ShapeFit> minimaOf(const ShapeProblem& problem, const ShapePrior& prior,
                               const std::vector<ShapeState>& starts);

}  // namespace lodeline
