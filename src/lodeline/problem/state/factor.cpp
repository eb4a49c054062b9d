#include "lodeline/problem/state/factor.h"

#include <Eigen/Core>

namespace lodeline {

double costOf(const Factor& factor, std::vector<double>& residual) {
  residual.resize(factor.function->num_residuals());
  factor.function->Evaluate(factor.blocks.data(), residual.data(), nullptr);
  const double squared = Eigen::Map<const Eigen::VectorXd>(residual.data(), residual.size()).squaredNorm();
  if (!factor.loss) return 0.5 * squared;
  double rho[3];
  factor.loss->Evaluate(squared, rho);
  return 0.5 * rho[0];
}

}  // namespace lodeline
