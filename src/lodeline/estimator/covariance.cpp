#include "lodeline/estimator/covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "lodeline/estimator/window_terms.h"

namespace lodeline {

namespace {

/// Relative sigma of a vector's length.
double lengthUncertainty(const Vec3& vector, const Mat3& covariance) {
  const double length = vector.norm();
  if (length < 1e-9) return std::numeric_limits<double>::infinity();
  const Vec3 direction = vector / length;
  return std::sqrt(direction.dot(covariance * direction)) / length;
}

}  // namespace

double scaleUncertainty(const Frame& newest, const Eigen::Matrix<double, 15, 15>& covariance) {
  return std::min(lengthUncertainty(newest.worldFromBody().translation, covariance.block<3, 3>(0, 0)),
                  speedUncertainty(newest, covariance));
}

double speedUncertainty(const Frame& newest, const Eigen::Matrix<double, 15, 15>& covariance) {
  return lengthUncertainty(newest.velocity_W(), covariance.block<3, 3>(6, 6));
}

Eigen::MatrixXd covarianceOf(const NormalEquations& system, const std::vector<const double*>& blocks) {
  std::vector<bool> wanted(static_cast<size_t>(system.size()), false);
  std::vector<int> last;
  for (const double* value : blocks) {
    const NormalEquations::Block& block = *system.find(value);
    for (int row = block.offset; row < block.offset + block.tangentSize(); ++row) {
      last.push_back(row);
      wanted[static_cast<size_t>(row)] = true;
    }
  }
  std::vector<int> order;
  for (int row = 0; row < system.size(); ++row) {
    if (!wanted[static_cast<size_t>(row)]) order.push_back(row);
  }
  order.insert(order.end(), last.begin(), last.end());
  const Eigen::MatrixXd hessian = system.hessian();
  const Eigen::VectorXd scale = hessian.diagonal().cwiseMax(1e-12).cwiseSqrt().cwiseInverse()(order);
  const Eigen::MatrixXd scaled = scale.asDiagonal() * hessian(order, order) * scale.asDiagonal();
  const auto size = static_cast<Eigen::Index>(last.size());
  const Eigen::LLT<Eigen::MatrixXd> factorised(scaled);
  Eigen::MatrixXd covariance;
  if (factorised.info() == Eigen::Success) {
    // With the wanted rows last, what the others say of them is all in the factor's last block.
    const Eigen::MatrixXd inverse_root = factorised.matrixLLT()
                                             .bottomRightCorner(size, size)
                                             .triangularView<Eigen::Lower>()
                                             .solve(Eigen::MatrixXd::Identity(size, size));
    covariance = inverse_root.transpose() * inverse_root;
  } else {
    const Eigen::MatrixXd selection = Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols()).rightCols(size);
    covariance = scaled.ldlt().solve(selection).bottomRows(size);
  }
  covariance = scale.tail(size).asDiagonal() * covariance * scale.tail(size).asDiagonal();
  return 0.5 * (covariance + covariance.transpose());
}

Eigen::Matrix<double, 15, 15> covarianceOf(const NormalEquations& system, const Frame& frame) {
  return covarianceOf(system, {frame.pose.data(), frame.motion.data()});
}

JointCovariance::JointCovariance(const NormalEquations& system, const Window& window) {
  const Frame& newest = window.newest();
  std::vector<const double*> blocks = {newest.pose.data(), newest.motion.data()};
  for (const auto& state : window.globals()) {
    if (state->is_correlation_wanted && system.find(state->value.data()))
      blocks.push_back(state->value.data());
  }
  int row = 0;
  for (const double* value : blocks) {
    const int size = system.find(value)->tangentSize();
    offsets_[value] = {row, size};
    row += size;
  }
  matrix_ = covarianceOf(system, blocks);
}

Eigen::MatrixXd JointCovariance::between(const double* rows, const double* columns) const {
  const auto& [row, height] = offsets_.at(rows);
  const auto& [column, width] = offsets_.at(columns);
  return matrix_.block(row, column, height, width);
}

JointCovariance jointCovariance(Window& window, const Prior& prior, const FactorMaker& factors) {
  return JointCovariance(linearise(collectTerms(window, prior, factors)), window);
}

Eigen::Matrix<double, 15, 15> newestCovariance(Window& window, const Prior& prior,
                                               const FactorMaker& factors) {
  return covarianceOf(linearise(collectTerms(window, prior, factors)), window.newest());
}

}  // namespace lodeline
