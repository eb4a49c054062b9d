#pragma once

#include <vector>

#include "lodeline/mapping/graph/graph_problem.h"
#include "lodeline/mapping/graph/pose_graph.h"
#include "lodeline/mapping/graph/robust/loop_support.h"

namespace lodeline {

/// Solves a graph of which some loops and control points are false.
///
/// Loops are taken in batches of falling support: the number of neighbouring loops that agree with a loop
/// less that of those that do not (neighbouringLoops()). Each passes a gate before it is used. Its residual r
/// at the present solution must lie within the chi-squared limit of its covariance R and the covariance P
/// of the prediction: r^T (R + P)^-1 r. After a batch the graph is solved with graduated weights over what
/// passed, and what then contradicts is taken out. Control points come last. Refused loops are tried again
/// until none passes.
///
/// Where the graph was solved before, new loops that all pass are added to that solution. Otherwise all
/// begins anew, so that the order in which loops were found matters little.
class RobustSolution {
 public:
  RobustSolution(GraphProblem* problem, const PoseGraphOptions& options, GraphSummary* summary);
  void run(bool was_solved);

 private:
  using Factors = std::vector<ReportedFactor*>;

  /// Adds what is new to the last solution. False where this makes the solution refuse anything more.
  bool extend();
  void rebuild();
  void findNeighbours();
  void takeInBatches();
  /// Tries refused loops again until none passes.
  void tryRefused();
  /// Uses refused loops with which more used ones agree than refused ones agree with each other, if this
  /// lowers the truncated cost: one false loop may have taken the place of several true ones.
  void reconsiderSupported();
  /// Sum of chi^2 of what is used, and of the limits of what is refused.
  double truncatedCost() const;
  double limitOf(const ReportedFactor& factor) const;
  /// Used loops with no more agreement than refused ones have among each other; none where none is refused.
  Factors weaklySupported(const AccidentalAgreement& accidental) const;
  /// Agreement of refused loops with each other.
  AccidentalAgreement accidentalAgreement() const;
  /// Takes out weakly supported loops whose gate is so wide that false ones pass it.
  void takeOutDoubtful();
  /// Takes refused loops that pass a gate which false ones do not. Whether there are any.
  bool admitCertain(const AccidentalAgreement& accidental);
  /// Sets the weight of the loops that pass the gate to 1. Their number.
  int admit(const Factors& candidates);
  /// Solves with all used factors and takes out those that contradict.
  void settle();
  /// Sets the weights of the truncated cost, 0 or 1. Whether any changes.
  bool truncate(const Factors& factors);
  std::vector<double> ratiosOf(const Factors& factors) const;
  Factors robust(bool is_used) const;
  Factors refusedLoops() const;
  void leastSquares(int most_iterations);

  GraphProblem* problem_;
  PoseGraphOptions options_;
  GraphSummary* summary_;
};

}  // namespace lodeline
