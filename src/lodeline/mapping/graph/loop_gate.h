#pragma once

#include <memory>
#include <vector>

#include "lodeline/mapping/graph/graph_problem.h"
#include "lodeline/mapping/graph/motion/accurate_paths.h"

namespace lodeline {

/// Compares loops with the present solution of a graph: chi^2 = r^T (R + P)^-1 r. r is the residual of a
/// loop that the solution does not use, R its covariance and P that of its prediction. P lies between
/// zero and the covariance along the most accurate path. Only where these bounds leave the decision open
/// does the gate compute P itself, from the normal matrix.
class LoopGate {
 public:
  /// `problem`: with a solution; `limit`: of chi^2.
  LoopGate(GraphProblem* problem, double limit);

  /// Loops that lie within the limit, in the order of their first nodes. Sets gate_chi_squared of all: exact,
  /// or a bound on the same side of the limit.
  std::vector<ReportedFactor*> passed(const std::vector<ReportedFactor*>& loops);

  /// Share of residuals with which the loop would pass. The higher it is, the less its passing tells.
  double shareThatPasses(const ReportedFactor& loop, const std::vector<Vec6>& residuals);

 private:
  double chiSquared(const ReportedFactor& loop, const Mat6* along_path);
  Mat6 predictionOf(const ReportedFactor& loop);

  GraphProblem* problem_;
  double limit_;
  AccuratePaths paths_;
  std::unique_ptr<GraphCovariance> covariance_;
};

}  // namespace lodeline
