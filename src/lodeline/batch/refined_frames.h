#pragma once

#include <vector>

#include "lodeline/batch/batch_problem.h"

namespace lodeline {

/// Estimates of all frames of the record from a solved problem. A frame between two states starts from the
/// one before it and follows the inertial readings; where these miss the state after it, the error is shared
/// out evenly over the time between. `inverse`: of the problem's system, for the covariances, which are nan
/// where it is null and are interpolated between states.
std::vector<FrameEstimate> refinedFrames(const BatchProblem& problem, const Rig& rig,
                                         const EstimatorOptions& options, const EstimatorLog& record,
                                         const BlockSkylineCholesky* inverse);

}  // namespace lodeline
