#pragma once

#include <vector>

#include "lodeline/batch/batch_problem.h"

namespace lodeline {

/// Estimates of all frames of the record from a solved problem. A frame between two states is propagated by
/// the inertial readings from the state before it. The error of this propagation at the state after it is
/// distributed evenly over the time between. `inverse`: inverse of the problem's system, for the covariances,
/// which are interpolated between states; they are nan where it is null.
std::vector<FrameEstimate> refinedFrames(const BatchProblem& problem, const Rig& rig,
                                         const EstimatorOptions& options, const EstimatorLog& record,
                                         const BlockSkylineCholesky* inverse);

}  // namespace lodeline
