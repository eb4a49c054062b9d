#pragma once

#include <vector>

#include "lodeline/batch/batch_problem.h"

namespace lodeline {

/// Covariances of all states of a problem, and of the field's azimuth with each; claimed errors of its ports.
/// Empty where not computed.
struct BatchCovariances {
  std::vector<Eigen::Matrix<double, 15, 15>> states;
  std::vector<AzimuthCovariance> azimuths;
  std::vector<Vec3> port_sigmas;

  bool empty() const { return states.empty(); }
};
/// Those of a solved problem, from the inverse of its system.
BatchCovariances covariancesOf(const BatchProblem& problem, const BlockSkylineCholesky& inverse);

/// Modelled errors of the poses of all states that no term contains (CovarianceInflation::root): 6 rows
/// [dp, dtheta] for each state, one column for each independent error.
using StateErrors = std::vector<Eigen::MatrixXd>;

/// Those errors without loops, at the present values.
StateErrors errorsAlongPath(const BatchProblem& problem, const Rig& rig, const EstimatorOptions& options,
                            const EstimatorLog& record);

/// The part of these errors that loops remove. Let e be the errors of all states without loops. Loops compare
/// states with each other and add the information L to the system, whose matrix is H with it. Where a loop
/// closes, it observes the error e and distributes its removal over the states: the remaining error is
/// e - H^-1 L e (a consider covariance; S. F. Schmidt, 1966). `factorized`: the system after factorize().
StateErrors errorsRemovedByLoops(BatchProblem& problem, const StateErrors& along_path,
                                 const BlockSkylineCholesky& factorized);

/// Estimates of all frames of the record from a solved problem. A frame between two states is propagated by
/// the inertial readings from the state before it. The error of this propagation at the state after it is
/// distributed evenly over the time between. The covariances are interpolated between states; they are nan
/// where they are empty. `posterior`: of the stated model; `reported`: without the information that is used
/// and not reported, to which the inflation is added. `removed`: by loops, from the inflation; empty without
/// loops.
std::vector<FrameEstimate> refinedFrames(const BatchProblem& problem, const Rig& rig,
                                         const EstimatorOptions& options, const EstimatorLog& record,
                                         const BatchCovariances& posterior, const BatchCovariances& reported,
                                         const StateErrors& removed = {});

}  // namespace lodeline
