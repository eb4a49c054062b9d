#pragma once

#include <Eigen/Core>
#include <vector>

#include "lodeline/estimator/problem/normal_equations.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// Cholesky factor of normal equations whose rows are put into an order that keeps most of their zeros. A
/// frame's velocity and biases touch those of its neighbours and, once these are eliminated in order of time,
/// the poses up to the next frame: nothing later. Eliminating them first takes a fraction of the time of a
/// dense factor when many frames have them, as while a window is starting up. The zeros are found in the
/// matrix itself, so any order gives the right factor.
class WindowCholesky {
 public:
  /// `first` are the blocks to be eliminated before all others, in the order given, `last` those to come
  /// after all others; the system must know them all.
  WindowCholesky(const NormalEquations& system, const std::vector<const double*>& first,
                 const std::vector<const double*>& last);

  /// Factorizes H + damping diag(H). False where that is not positive definite.
  bool factorize(double damping);

  /// The solution x of (H + damping diag(H)) x = b, rows as in the system. After factorize().
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

  /// Covariance (inverse of H + damping diag(H)) of the blocks `last`, stacked. After factorize().
  Eigen::MatrixXd covarianceOfLast() const;

 private:
  /// Consecutive rows below the diagonal in which a block of columns is not zero.
  struct Run {
    int row, size;
  };
  std::vector<Run> runsBelow(int column, int size) const;
  bool eliminate(int column, int size);

  std::vector<int> order_;  ///< row of the system that comes at each place
  std::vector<int> sizes_;  ///< of the blocks of columns that are eliminated together
  int last_size_ = 0;
  Eigen::VectorXd scale_;    ///< roots of the diagonal's inverse, in order
  Eigen::MatrixXd ordered_;  ///< H in order, with a diagonal of ones; lower triangle
  Eigen::MatrixXd factor_;   ///< lower triangle
};

/// The velocities and biases of all frames that have them, but of the newest, in order of time: what is best
/// eliminated first.
std::vector<const double*> motionsButTheNewest(const Window& window);

}  // namespace lodeline
