#include "lodeline/factors/prior_factor.h"

namespace lodeline {

int Prior::tangentSize() const {
  int size = 0;
  for (const Block& block : blocks) size += block.tangentSize();
  return size;
}

void Prior::append(double* value, int size, const Eigen::VectorXd& sigmas) {
  const int before = tangentSize();
  blocks.push_back({value, Eigen::Map<const Eigen::VectorXd>(value, size)});
  const int after = tangentSize();
  Eigen::MatrixXd grown = Eigen::MatrixXd::Zero(after, after);
  grown.topLeftCorner(before, before) = sqrt_information;
  grown.diagonal().tail(after - before) = sigmas.cwiseInverse();
  sqrt_information = std::move(grown);
  information.resize(0, 0);
  offset.conservativeResizeLike(Eigen::VectorXd::Zero(after));
}

Eigen::VectorXd Prior::difference(double const* const* values) const {
  Eigen::VectorXd d(tangentSize());
  int row = 0;
  for (size_t i = 0; i < blocks.size(); ++i) {
    const Eigen::VectorXd& first = blocks[i].linearization_point;
    if (blocks[i].isPose()) {
      d.segment<6>(row) = perturbationBetween(poseFromBlock(first.data()), poseFromBlock(values[i]));
    } else {
      d.segment(row, first.size()) = Eigen::Map<const Eigen::VectorXd>(values[i], first.size()) - first;
    }
    row += blocks[i].tangentSize();
  }
  return d;
}

PriorFactor::PriorFactor(const Prior& prior) : prior_(prior) {
  set_num_residuals(static_cast<int>(prior.offset.size()));
  for (const Prior::Block& block : prior.blocks) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(block.linearization_point.size()));
  }
}

bool PriorFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  Eigen::Map<Eigen::VectorXd> residual(residuals, prior_.offset.size());
  residual = prior_.offset;
  residual.noalias() +=
      prior_.sqrt_information.triangularView<Eigen::Upper>() * prior_.difference(parameters);
  if (!jacobians) return true;

  int column = 0;
  for (size_t i = 0; i < prior_.blocks.size(); ++i) {
    const int tangent = prior_.blocks[i].tangentSize();
    if (jacobians[i]) {
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
      Eigen::Map<RowMajor> jacobian(jacobians[i], residual.size(),
                                    prior_.blocks[i].linearization_point.size());
      jacobian.setZero();
      jacobian.leftCols(tangent) = prior_.sqrt_information.middleCols(column, tangent);
    }
    column += tangent;
  }
  return true;
}

}  // namespace lodeline
