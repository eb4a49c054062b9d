#include "lodeline/estimator/prior_terms.h"

namespace lodeline {

PriorTerms::PriorTerms(const Prior& prior) : prior_(prior) {
  int offset = 0;
  for (const Prior::Block& block : prior.blocks) {
    blocks_.push_back({block.value, static_cast<int>(block.first_estimate.size()), offset});
    offset += block.tangentSize();
  }
  hessian_ = Eigen::MatrixXd::Zero(offset, offset);
  hessian_.selfadjointView<Eigen::Lower>().rankUpdate(prior.sqrt_information.transpose());
}

Eigen::VectorXd PriorTerms::residual() const {
  std::vector<const double*> values;
  for (const Prior::Block& block : prior_.blocks) values.push_back(block.value);
  return prior_.sqrt_information.triangularView<Eigen::Upper>() * prior_.difference(values.data()) +
         prior_.offset;
}

void PriorTerms::addTo(NormalEquations* system) const {
  if (prior_.empty()) return;
  system->add(blocks_, hessian_,
              prior_.sqrt_information.triangularView<Eigen::Upper>().transpose() * residual());
}

}  // namespace lodeline
