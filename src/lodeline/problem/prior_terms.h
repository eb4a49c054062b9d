#pragma once

#include "lodeline/factors/prior_factor.h"
#include "lodeline/problem/normal_equations.h"

namespace lodeline {

/// The prior's part of a window's cost, as in PriorFactor, with its constant Hessian computed once.
class PriorTerms {
 public:
  /// The prior must outlive the terms.
  explicit PriorTerms(const Prior& prior);

  /// At the blocks' present values.
  double cost() const { return 0.5 * residual().squaredNorm(); }
  void addTo(NormalEquations* system) const;

 private:
  Eigen::VectorXd residual() const;

  const Prior& prior_;
  std::vector<NormalEquations::Block> blocks_;
  Eigen::MatrixXd hessian_;  ///< lower triangle; empty where the prior has it
};

}  // namespace lodeline
