#pragma once

#include <map>
#include <utility>
#include <vector>

#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/normal_equations.h"

namespace lodeline {

/// Variance that means "unknown": a sigma of a million metres, radians and so on.
constexpr double kUnknownVariance = 1e12;

/// Whether all variances are positive, finite and known.
bool isCovariance(const Eigen::MatrixXd& matrix);

/// Covariance of one frame's [dp, dtheta, dv, db_g, db_a] in a linearized window.
Eigen::Matrix<double, 15, 15> covarianceOf(const NormalEquations& system, const Frame& frame);

/// Joint covariance of some of a system's blocks, stacked in the order given; kUnknownVariance where rounding
/// has left the system without a positive definite Hessian. `eliminated_first`: other blocks in their best
/// order of elimination (see WindowCholesky), where one is known.
Eigen::MatrixXd covarianceOf(const NormalEquations& system, const std::vector<const double*>& blocks,
                             const std::vector<const double*>& eliminated_first = {});

/// Pose and motion of the newest frame, and the parameter blocks of the system whose correlation is wanted
/// (ParameterBlock::is_correlation_wanted).
std::vector<const double*> correlatedBlocks(const NormalEquations& system, const Window& window);

/// Joint covariance of the correlatedBlocks() of a window.
class JointCovariance {
 public:
  JointCovariance() = default;
  JointCovariance(const NormalEquations& system, const Window& window);
  /// From a known covariance `matrix` of the correlatedBlocks(), stacked.
  JointCovariance(const NormalEquations& system, const std::vector<const double*>& blocks,
                  Eigen::MatrixXd matrix);

  bool empty() const { return offsets_.empty(); }
  bool knows(const double* block) const { return offsets_.count(block) > 0; }
  /// Covariance of two blocks' tangent coordinates; both must be known.
  Eigen::MatrixXd between(const double* rows, const double* columns) const;
  /// Covariance of the newest frame's [dp, dtheta, dv, db_g, db_a].
  Eigen::Matrix<double, 15, 15> newest() const { return matrix_.topLeftCorner<15, 15>(); }
  /// Covariance without `information` on a known block (symmetric; its negative parts do not count). In a
  /// direction without other information, a millionth of the information remains.
  JointCovariance without(const double* block, const Eigen::MatrixXd& information) const;

 private:
  Eigen::MatrixXd matrix_;
  std::map<const double*, std::pair<int, int>> offsets_;  ///< first row and size
};

/// Relative standard deviation of the scale from the newest frame: that of its distance from the origin or of
/// its speed, along their directions, whichever is smaller. `covariance` as from newestCovariance().
double scaleUncertainty(const Frame& newest, const Eigen::Matrix<double, 15, 15>& covariance);
/// Relative standard deviation of the newest frame's speed alone.
double speedUncertainty(const Frame& newest, const Eigen::Matrix<double, 15, 15>& covariance);

/// Covariance of the newest frame's [dp, dtheta, dv, db_g, db_a], given all terms of the window.
Eigen::Matrix<double, 15, 15> newestCovariance(Window& window, const Prior& prior,
                                               const FactorBuilder& factors);
/// The same with the parameter blocks.
JointCovariance jointCovariance(Window& window, const Prior& prior, const FactorBuilder& factors);

}  // namespace lodeline
