#pragma once

#include <Eigen/Core>
#include <vector>

#include "lodeline/problem/normal_equations.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Cholesky factor of normal equations whose rows are ordered to preserve most of their zeros. Velocity and
/// biases of a frame are coupled only to those of its neighbours. Once these are eliminated in order of time,
/// they are also coupled to the poses up to the next frame. Eliminating them first takes a fraction of the
/// time of a dense factor when many frames have them, as while a window is starting up. The zeros are found
/// in the matrix itself, so any order gives the correct factor.
class WindowCholesky {
 public:
  /// `first`: blocks to be eliminated before all others, in the order given; `last`: blocks after all others.
  /// The system must contain them all.
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

  std::vector<int> order_;  ///< row of the system at each position
  std::vector<int> sizes_;  ///< sizes of the column blocks that are eliminated together
  int last_size_ = 0;
  Eigen::VectorXd scale_;    ///< inverse square roots of the diagonal, in order
  Eigen::MatrixXd ordered_;  ///< H in order, scaled to a unit diagonal; lower triangle
  Eigen::MatrixXd factor_;   ///< lower triangle
};

/// Motion blocks of all frames that have them except the newest, in order of time: the best blocks to
/// eliminate first.
std::vector<const double*> motionsButTheNewest(const Window& window);

}  // namespace lodeline
