#pragma once

#include <Eigen/Core>

namespace lodeline {

/// Robust linear least squares of three right sides (axes of a field) with common rows and weights.
struct RobustLines {
  Eigen::MatrixXd coefficients;  ///< a row for each column of the design, a column for each axis
  Eigen::MatrixXd residuals;     ///< a row for each row of the design
  Eigen::VectorXd weights;       ///< 0 to 1; 0 for rows that are no numbers
  Eigen::MatrixXd information;   ///< design^T W design without priors
  Eigen::MatrixXd inverse;       ///< of `information` with the priors
  double sigma = 0.0;            ///< robust, of one residual
  double cost = 0.0;             ///< sum of log(1 + square / (c sigma)^2) over the rows, with the sigma given
};

/// Iteratively reweighted least squares with Cauchy's weights 1 / (1 + (r / (2.385 sigma))^2), r the root
/// mean square of a row's residuals over the axes. Source: Holland and Welsch, "Robust regression using
/// iteratively reweighted least-squares", 1977. `prior_sigmas`: one for each column of the design, about
/// zero, in units of the coefficients; infinite for none. `sigma`: of a residual, where it is known; 0
/// determines it from the residuals. Rows of the design that are no numbers do not count.
RobustLines fitLines(const Eigen::MatrixXd& design, const Eigen::MatrixXd& right,
                     const Eigen::VectorXd& prior_sigmas, double sigma = 0.0);

}  // namespace lodeline
