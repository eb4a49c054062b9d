#pragma once

#include <string>
#include <vector>

#include "lodeline/evaluation/figures/gnuplot.h"
#include "lodeline/trajectory.h"

namespace lodeline {

/// The evaluation of one of several estimates against the same reference.
struct NamedEvaluation {
  std::string name;  ///< differs from those of the others
  Evaluation evaluation;
};

/// One row per estimate: completion, absolute errors, scale and end point.
std::string severalTable(const std::vector<NamedEvaluation>& estimates);

/// Position error of all estimates over time, one curve each.
gnuplot::Figure severalErrorsFigure(const std::vector<NamedEvaluation>& estimates);

/// Top view of all aligned estimates and the reference.
gnuplot::Figure severalPathsFigure(const std::vector<NamedEvaluation>& estimates);

}  // namespace lodeline
