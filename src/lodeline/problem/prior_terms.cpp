#include "lodeline/problem/prior_terms.h"

#include <algorithm>

#include "lodeline/problem/simd_gemm.h"

namespace lodeline {

PriorTerms::PriorTerms(const Prior& prior) : prior_(prior) {
  int offset = 0;
  for (const Prior::Block& block : prior.blocks) {
    blocks_.push_back({block.value, static_cast<int>(block.linearization_point.size()), offset});
    offset += block.tangentSize();
  }
  if (prior.information.size() > 0) return;
  // J^T J, a few rows of J at a time, because they are zero left of the diagonal.
  constexpr int kRows = 24;
  const Eigen::MatrixXd transposed = prior.sqrt_information.transpose();
  hessian_ = Eigen::MatrixXd::Zero(offset, offset);
  for (int row = 0; row < offset; row += kRows) {
    const int rest = offset - row, rows = std::min(kRows, rest);
    subtractSquare(transposed.block(row, row, rest, rows), hessian_.bottomRightCorner(rest, rest));
  }
  hessian_ = -hessian_;
}

Eigen::VectorXd PriorTerms::residual() const {
  std::vector<const double*> values;
  for (const Prior::Block& block : prior_.blocks) values.push_back(block.value);
  return prior_.sqrt_information.triangularView<Eigen::Upper>() * prior_.difference(values.data()) +
         prior_.offset;
}

void PriorTerms::addTo(NormalEquations* system) const {
  if (prior_.empty()) return;
  system->add(blocks_, prior_.information.size() > 0 ? prior_.information : hessian_,
              prior_.sqrt_information.triangularView<Eigen::Upper>().transpose() * residual());
}

}  // namespace lodeline
