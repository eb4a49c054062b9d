#pragma once

#include <vector>

#include "lodeline/batch/batch_problem.h"

namespace lodeline {

/// Covariances of all states of a problem, and of the field's azimuth with each; empty where not computed.
struct BatchCovariances {
  std::vector<Eigen::Matrix<double, 15, 15>> states;
  std::vector<AzimuthCovariance> azimuths;

  bool empty() const { return states.empty(); }
};
/// Those of a solved problem, from the inverse of its system.
BatchCovariances covariancesOf(const BatchProblem& problem, const BlockSkylineCholesky& inverse);

/// Estimates of all frames of the record from a solved problem. A frame between two states is propagated by
/// the inertial readings from the state before it. The error of this propagation at the state after it is
/// distributed evenly over the time between. The covariances are interpolated between states; they are nan
/// where they are empty. `posterior`: of the stated model; `reported`: without the information that is used
/// and not reported, to which the inflation is added.
std::vector<FrameEstimate> refinedFrames(const BatchProblem& problem, const Rig& rig,
                                         const EstimatorOptions& options, const EstimatorLog& record,
                                         const BatchCovariances& posterior, const BatchCovariances& reported);

}  // namespace lodeline
