#include "lodeline/estimator/normal_equations.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace lodeline {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Mat63 = Eigen::Matrix<double, 6, 3>;
using Mat26 = Eigen::Matrix<double, 2, 6>;

// Eigenvalues of a landmark's scaled 3x3 system below this share of the largest count as unobserved.
constexpr double kRankTolerance = 1e-10;
// So does a coordinate with less information than this: an inverse distance that is known to 1000 per metre
// is not known, and scaling would blow its rounding errors up to a direction that takes information away.
constexpr double kLeastInformation = 1e-6;

/// Scales residual and Jacobians by the square root of the loss's slope (iteratively reweighted least
/// squares).
double robustScale(const ceres::LossFunction* loss, double squared_norm) {
  if (!loss) return 1.0;
  double rho[3];
  loss->Evaluate(squared_norm, rho);
  return std::sqrt(rho[1]);
}

/// Inverse of a positive semi-definite 3x3 matrix on its range, insensitive to the units of its coordinates.
Mat3 pseudoInverse(const Mat3& matrix) {
  const Vec3 scale = matrix.diagonal().cwiseMax(kLeastInformation).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(scale.asDiagonal() * matrix * scale.asDiagonal());
  const double threshold = kRankTolerance * solver.eigenvalues()[2];
  const Vec3 inverted =
      (solver.eigenvalues().array() > threshold).select(solver.eigenvalues().cwiseInverse(), Vec3::Zero());
  return scale.asDiagonal() * solver.eigenvectors() * inverted.asDiagonal() *
         solver.eigenvectors().transpose() * scale.asDiagonal();
}

}  // namespace

void NormalEquations::reserve(int size) {
  if (size <= h_.rows()) return;
  const int capacity = std::max<int>(size, 2 * static_cast<int>(h_.rows()));
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(capacity, capacity);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(capacity);
  h.topLeftCorner(size_, size_) = h_.topLeftCorner(size_, size_);
  g.head(size_) = g_.head(size_);
  h_.swap(h);
  g_.swap(g);
}

const NormalEquations::Block* NormalEquations::find(const double* value) const {
  for (const Block& block : blocks_) {
    if (block.value == value) return &block;
  }
  return nullptr;
}

int NormalEquations::offsetOf(double* value, int ambient_size) {
  if (const Block* block = find(value)) return block->offset;
  const Block block{value, ambient_size, size_};
  reserve(size_ + block.tangentSize());
  size_ += block.tangentSize();
  blocks_.push_back(block);
  return block.offset;
}

void NormalEquations::add(const Factor& factor) {
  const std::vector<int>& sizes = factor.function->parameter_block_sizes();
  const int rows = factor.function->num_residuals();
  Eigen::VectorXd residual(rows);
  std::vector<RowMajor> jacobians;
  std::vector<double*> pointers;
  for (const int size : sizes) jacobians.emplace_back(rows, size);
  for (RowMajor& jacobian : jacobians) pointers.push_back(jacobian.data());
  factor.function->Evaluate(factor.blocks.data(), residual.data(), pointers.data());
  const double scale = robustScale(factor.loss, residual.squaredNorm());

  std::vector<int> offsets;
  int columns = 0;
  for (size_t b = 0; b < sizes.size(); ++b) {
    offsets.push_back(offsetOf(factor.blocks[b], sizes[b]));
    columns += find(factor.blocks[b])->tangentSize();
  }
  for (size_t i = 0; i < sizes.size(); ++i) {
    const int size_i = find(factor.blocks[i])->tangentSize();
    const auto jacobian_i = jacobians[i].leftCols(size_i);
    g_.segment(offsets[i], size_i) += scale * scale * jacobian_i.transpose() * residual;
    for (size_t j = 0; j < sizes.size(); ++j) {
      if (offsets[j] > offsets[i]) continue;
      const int size_j = find(factor.blocks[j])->tangentSize();
      h_.block(offsets[i], offsets[j], size_i, size_j).noalias() +=
          scale * scale * jacobian_i.transpose() * jacobians[j].leftCols(size_j);
    }
  }
}

void NormalEquations::addEliminated(const LandmarkFactors& landmark) {
  std::vector<Coupling> couplings;
  const auto couplingOf = [&](int offset) -> Coupling& {
    for (Coupling& coupling : couplings) {
      if (coupling.offset == offset) return coupling;
    }
    return couplings.emplace_back(Coupling{offset});
  };
  Mat3 h_landmark = Mat3::Zero();
  Vec3 g_landmark = Vec3::Zero();

  for (const Factor& factor : landmark.factors) {
    Vec2 residual;
    Eigen::Matrix<double, 2, kPoseSize, Eigen::RowMajor> by_pose[2];
    Eigen::Matrix<double, 2, kLandmarkSize, Eigen::RowMajor> by_landmark;
    const bool in_host = factor.blocks.size() == 1;
    double* host_pointers[] = {by_landmark.data()};
    double* pointers[] = {by_pose[0].data(), by_pose[1].data(), by_landmark.data()};
    factor.function->Evaluate(factor.blocks.data(), residual.data(), in_host ? host_pointers : pointers);
    const double scale = robustScale(factor.loss, residual.squaredNorm());
    residual *= scale;
    by_landmark *= scale;
    h_landmark.noalias() += by_landmark.transpose() * by_landmark;
    g_landmark.noalias() += by_landmark.transpose() * residual;
    if (in_host) continue;

    int offsets[2];
    Mat26 jacobians[2];
    for (int k = 0; k < 2; ++k) {
      offsets[k] = offsetOf(factor.blocks[k], kPoseSize);
      jacobians[k] = scale * by_pose[k].leftCols<6>();
      g_.segment<6>(offsets[k]) += jacobians[k].transpose() * residual;
      h_.block<6, 6>(offsets[k], offsets[k]).noalias() += jacobians[k].transpose() * jacobians[k];
      couplingOf(offsets[k]).pose_by_landmark.noalias() += jacobians[k].transpose() * by_landmark;
    }
    const int low = offsets[0] > offsets[1] ? 0 : 1;
    h_.block<6, 6>(offsets[low], offsets[1 - low]).noalias() +=
        jacobians[low].transpose() * jacobians[1 - low];
  }

  const Mat3 inverse = pseudoInverse(h_landmark);
  for (const Coupling& row : couplings) {
    const Mat63 weighted = row.pose_by_landmark * inverse;
    g_.segment<6>(row.offset).noalias() -= weighted * g_landmark;
    for (const Coupling& column : couplings) {
      if (column.offset > row.offset) continue;
      h_.block<6, 6>(row.offset, column.offset).noalias() -= weighted * column.pose_by_landmark.transpose();
    }
  }
  eliminated_.push_back({landmark.landmark, inverse, g_landmark, std::move(couplings)});
}

void NormalEquations::stepLandmarks(const Eigen::VectorXd& step) const {
  for (const EliminatedLandmark& landmark : eliminated_) {
    Vec3 gradient = landmark.gradient;
    for (const Coupling& coupling : landmark.couplings) {
      gradient.noalias() += coupling.pose_by_landmark.transpose() * step.segment<6>(coupling.offset);
    }
    Eigen::Map<Eigen::Matrix<double, kLandmarkSize, 1>> value(landmark.value);
    value -= landmark.inverse_hessian * gradient;
  }
}

Eigen::MatrixXd NormalEquations::hessian() const {
  Eigen::MatrixXd full = h_.topLeftCorner(size_, size_).selfadjointView<Eigen::Lower>();
  return full;
}

}  // namespace lodeline
