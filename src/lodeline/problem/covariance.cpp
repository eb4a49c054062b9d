#include "lodeline/problem/covariance.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "lodeline/problem/window_cholesky.h"
#include "lodeline/problem/window_terms.h"

namespace lodeline {

namespace {

/// Relative sigma of a vector's norm.
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
  if (cholesky.factorize(0.0)) return cholesky.covarianceOfLast();
  // Rounding of the largest informations has absorbed smaller ones, so that some directions are unbounded.
  Eigen::Index size = 0;
  for (const double* value : blocks) size += system.find(value)->tangentSize();
  return kUnknownVariance * Eigen::MatrixXd::Identity(size, size);
}

Eigen::Matrix<double, 15, 15> covarianceOf(const NormalEquations& system, const Frame& frame) {
  return covarianceOf(system, {frame.pose.data(), frame.motion.data()});
}

std::vector<const double*> correlatedBlocks(const NormalEquations& system, const Window& window) {
  const Frame& newest = window.newest();
  std::vector<const double*> blocks = {newest.pose.data()};
  if (newest.has_motion) blocks.push_back(newest.motion.data());
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
  // (P^-1 - V V^T)^-1 = P + P V (I - V^T P V)^-1 V^T P by Woodbury's identity. The eigenvalues of V^T P V are
  // the shares of the removed information in the total information. A robust or changing prior, or rounding,
  // may make them 1 or more, which would give negative variances.
  constexpr double kGreatestShare = 1.0 - 1e-6;
  const Eigen::MatrixXd directions =
      told.eigenvectors().rightCols(count) * told.eigenvalues().tail(count).cwiseSqrt().asDiagonal();
  const Eigen::MatrixXd across = matrix_.middleCols(offset, size) * directions;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> shares(directions.transpose() *
                                                              across.middleRows(offset, size));
  const Eigen::VectorXd rest = 1.0 - shares.eigenvalues().array().min(kGreatestShare);
  const Eigen::MatrixXd moved = across * shares.eigenvectors();
  without.matrix_ += moved * rest.cwiseInverse().asDiagonal() * moved.transpose();
  without.matrix_ = 0.5 * (without.matrix_ + without.matrix_.transpose()).eval();
  return without;
}

bool isCovariance(const Eigen::MatrixXd& matrix) {
  return matrix.allFinite() && matrix.diagonal().minCoeff() > 0.0 &&
         matrix.diagonal().maxCoeff() < kUnknownVariance;
}

JointCovariance jointCovariance(Window& window, const Prior& prior, const FactorBuilder& factors) {
  return JointCovariance(linearize(collectTerms(window, prior, factors)), window);
}

Eigen::Matrix<double, 15, 15> newestCovariance(Window& window, const Prior& prior,
                                               const FactorBuilder& factors) {
  return covarianceOf(linearize(collectTerms(window, prior, factors)), window.newest());
}

}  // namespace lodeline
