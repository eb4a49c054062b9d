#include "lodeline/estimator/covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "lodeline/estimator/window_cholesky.h"
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

Eigen::MatrixXd covarianceOf(const NormalEquations& system, const std::vector<const double*>& blocks,
                             const std::vector<const double*>& eliminated_first) {
  WindowCholesky cholesky(system, eliminated_first, blocks);
  if (cholesky.factorise(0.0)) return cholesky.covarianceOfLast();
  // Nearly singular: slower, but it finds what there is.
  std::vector<int> rows;
  for (const double* value : blocks) {
    const NormalEquations::Block& block = *system.find(value);
    for (int i = 0; i < block.tangentSize(); ++i) rows.push_back(block.offset + i);
  }
  const Eigen::MatrixXd hessian = system.hessian();
  const Eigen::VectorXd scale = hessian.diagonal().cwiseMax(1e-12).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(system.size(), system.size());
  const Eigen::MatrixXd scaled = scale.asDiagonal() * hessian * scale.asDiagonal();
  Eigen::MatrixXd covariance = scaled.ldlt().solve(identity)(rows, rows);
  covariance = scale(rows).asDiagonal() * covariance * scale(rows).asDiagonal();
  return 0.5 * (covariance + covariance.transpose());
}

Eigen::Matrix<double, 15, 15> covarianceOf(const NormalEquations& system, const Frame& frame) {
  return covarianceOf(system, {frame.pose.data(), frame.motion.data()});
}

std::vector<const double*> correlatedBlocks(const NormalEquations& system, const Window& window) {
  const Frame& newest = window.newest();
  std::vector<const double*> blocks = {newest.pose.data(), newest.motion.data()};
  for (const auto& state : window.globals()) {
    if (state->is_correlation_wanted && system.find(state->value.data()))
      blocks.push_back(state->value.data());
  }
  return blocks;
}

JointCovariance::JointCovariance(const NormalEquations& system, const Window& window)
    : JointCovariance(system, correlatedBlocks(system, window),
                      covarianceOf(system, correlatedBlocks(system, window), motionsButTheNewest(window))) {}

JointCovariance::JointCovariance(const NormalEquations& system, const std::vector<const double*>& blocks,
                                 Eigen::MatrixXd matrix)
    : matrix_(std::move(matrix)) {
  int row = 0;
  for (const double* value : blocks) {
    const int size = system.find(value)->tangentSize();
    offsets_[value] = {row, size};
    row += size;
  }
}

Eigen::MatrixXd JointCovariance::between(const double* rows, const double* columns) const {
  const auto& [row, height] = offsets_.at(rows);
  const auto& [column, width] = offsets_.at(columns);
  return matrix_.block(row, column, height, width);
}

JointCovariance JointCovariance::without(const double* block, const Eigen::MatrixXd& information) const {
  const auto& [offset, size] = offsets_.at(block);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> told(information);
  const double least = 1e-12 * told.eigenvalues().cwiseAbs().maxCoeff();
  JointCovariance without = *this;
  const int count = static_cast<int>((told.eigenvalues().array() > least).count());
  if (count == 0) return without;
  // (P^-1 - V J V^T)^-1 by Woodbury's identity.
  const Eigen::MatrixXd directions = told.eigenvectors().rightCols(count);
  const Eigen::MatrixXd across = matrix_.middleCols(offset, size) * directions;
  const Eigen::MatrixXd rest = Eigen::MatrixXd(told.eigenvalues().tail(count).cwiseInverse().asDiagonal()) -
                               directions.transpose() * across.middleRows(offset, size);
  without.matrix_ += across * rest.ldlt().solve(across.transpose());
  without.matrix_ = 0.5 * (without.matrix_ + without.matrix_.transpose()).eval();
  return without;
}

JointCovariance jointCovariance(Window& window, const Prior& prior, const FactorMaker& factors) {
  return JointCovariance(linearise(collectTerms(window, prior, factors)), window);
}

Eigen::Matrix<double, 15, 15> newestCovariance(Window& window, const Prior& prior,
                                               const FactorMaker& factors) {
  return covarianceOf(linearise(collectTerms(window, prior, factors)), window.newest());
}

}  // namespace lodeline
