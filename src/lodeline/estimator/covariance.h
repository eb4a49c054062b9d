#pragma once

#include "lodeline/estimator/factor_list.h"
#include "lodeline/estimator/normal_equations.h"

namespace lodeline {

/// Covariance of one frame's [dp, dtheta, dv, db_g, db_a] in a linearised window.
Eigen::Matrix<double, 15, 15> covarianceOf(const NormalEquations& system, const Frame& frame);

/// Joint covariance of some of the blocks that a system holds, stacked in the order given.
Eigen::MatrixXd covarianceOf(const NormalEquations& system, const std::vector<const double*>& blocks);

/// Relative standard deviation of the scale as the newest frame shows it: of its distance from the origin or
/// of its speed along their directions, whichever is known better. `covariance` as from newestCovariance().
double scaleUncertainty(const Frame& newest, const Eigen::Matrix<double, 15, 15>& covariance);

/// Covariance of the newest frame's [dp, dtheta, dv, db_g, db_a], given everything in the window.
Eigen::Matrix<double, 15, 15> newestCovariance(Window& window, const Prior& prior,
                                               const FactorMaker& factors);

}  // namespace lodeline
