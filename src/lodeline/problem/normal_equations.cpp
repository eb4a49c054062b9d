#include "lodeline/problem/normal_equations.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace lodeline {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Eigenvalues of a landmark's scaled 3x3 system below this share of the largest count as unobserved.
constexpr double kRankTolerance = 1e-10;
// A coordinate with less information than this also counts as unobserved. An inverse distance known to 1000
// per metre contains no information. The scaling would amplify its rounding errors to a direction with
// negative information.
constexpr double kLeastInformation = 1e-6;
// Determinant of the scaled system above which all three coordinates are known and eigenvalues need not be
// computed.
constexpr double kClearDeterminant = 1e-6;

/// Factor on residual and Jacobians: the square root of the loss's derivative (iteratively reweighted least
/// squares).
double robustScale(const ceres::LossFunction* loss, double squared_norm) {
  if (!loss) return 1.0;
  double rho[3];
  loss->Evaluate(squared_norm, rho);
  return std::sqrt(rho[1]);
}

}  // namespace

Mat3 landmarkInverseRoot(const Mat3& hessian) {
  const Vec3 scale = hessian.diagonal().cwiseMax(kLeastInformation).cwiseSqrt().cwiseInverse();
  const Mat3 scaled = scale.asDiagonal() * hessian * scale.asDiagonal();
  // The eigenvalues of `scaled` are at most 3, so its determinant is a lower bound of the smallest: far above
  // it, the rank is certain.
  const Eigen::LLT<Mat3> root(scaled);
  const Vec3 diagonal = root.matrixLLT().diagonal();
  if (root.info() == Eigen::Success && diagonal.prod() * diagonal.prod() > kClearDeterminant)
    return scale.asDiagonal() * root.matrixU().solve(Mat3::Identity());
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(scaled);
  const double threshold = kRankTolerance * solver.eigenvalues()[2];
  const Vec3 inverted =
      (solver.eigenvalues().array() > threshold).select(solver.eigenvalues().cwiseInverse(), Vec3::Zero());
  return scale.asDiagonal() * solver.eigenvectors() * inverted.cwiseSqrt().asDiagonal();
}

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
  const double scale = robustScale(factor.loss.get(), residual.squaredNorm());

  std::vector<int> offsets;
  for (size_t b = 0; b < sizes.size(); ++b) offsets.push_back(offsetOf(factor.blocks[b], sizes[b]));
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

void NormalEquations::add(const std::vector<Block>& blocks, const Eigen::MatrixXd& h,
                          const Eigen::VectorXd& g) {
  std::vector<int> offsets;
  for (const Block& block : blocks) offsets.push_back(offsetOf(block.value, block.ambient_size));
  for (size_t i = 0; i < blocks.size(); ++i) {
    const int size_i = blocks[i].tangentSize();
    g_.segment(offsets[i], size_i) += g.segment(blocks[i].offset, size_i);
    for (size_t j = 0; j <= i; ++j) {
      const int size_j = blocks[j].tangentSize();
      const auto product = h.block(blocks[i].offset, blocks[j].offset, size_i, size_j);
      if (offsets[j] <= offsets[i]) {
        h_.block(offsets[i], offsets[j], size_i, size_j) += product;
      } else {
        h_.block(offsets[j], offsets[i], size_j, size_i) += product.transpose();
      }
    }
  }
}

/// One factor of a landmark, linearized: the residual, its derivative by the landmark and by every other
/// block, all scaled by the loss.
struct NormalEquations::LandmarkTerm {
  static constexpr int kMaxBlocks =
      9;  // three poses, landmark, extrinsics twice, time offset, intrinsics, shutter
  struct Part {
    int offset, size;
    Eigen::Matrix<double, 2, kMostCoordinates> jacobian;  // columns beyond `size` are zero
  };
  Vec2 residual;
  Eigen::Matrix<double, 2, kLandmarkSize, Eigen::RowMajor> by_landmark;
  Part parts[kMaxBlocks];
  int part_count = 0;
};

NormalEquations::LandmarkTerm NormalEquations::linearized(const Factor& factor, const double* landmark) {
  const std::vector<int>& sizes = factor.function->parameter_block_sizes();
  LandmarkTerm term;
  Eigen::Matrix<double, 2, kMostCoordinates, Eigen::RowMajor> by_block[LandmarkTerm::kMaxBlocks];
  double* pointers[LandmarkTerm::kMaxBlocks];
  for (size_t b = 0; b < sizes.size(); ++b)
    pointers[b] = factor.blocks[b] == landmark ? term.by_landmark.data() : by_block[b].data();
  factor.function->Evaluate(factor.blocks.data(), term.residual.data(), pointers);
  const double scale = robustScale(factor.loss.get(), term.residual.squaredNorm());
  term.residual *= scale;
  term.by_landmark *= scale;
  for (size_t b = 0; b < sizes.size(); ++b) {
    if (factor.blocks[b] == landmark) continue;
    LandmarkTerm::Part& part = term.parts[term.part_count++];
    part.offset = offsetOf(factor.blocks[b], sizes[b]);
    part.size = sizes[b] == kPoseSize ? kPoseTangentSize : sizes[b];
    part.jacobian.setZero();
    const Eigen::Map<RowMajor> given(pointers[b], 2, sizes[b]);
    if (part.size == kPoseTangentSize) {
      part.jacobian.leftCols<kPoseTangentSize>() = scale * given.leftCols<kPoseTangentSize>();
    } else {
      part.jacobian.leftCols(part.size) = scale * given.leftCols(part.size);
    }
  }
  return term;
}

void NormalEquations::addProduct(int row, int row_size, int column, int column_size, const Product& product) {
  if (row_size == kPoseTangentSize && column_size == kPoseTangentSize) {
    h_.block<kPoseTangentSize, kPoseTangentSize>(row, column) +=
        product.topLeftCorner<kPoseTangentSize, kPoseTangentSize>();
  } else {
    h_.block(row, column, row_size, column_size) += product.topLeftCorner(row_size, column_size);
  }
}

void NormalEquations::addEliminated(const LandmarkFactors& landmark) {
  std::vector<Coupling> couplings;
  const auto couplingOf = [&](int offset, int size) -> Coupling& {
    for (Coupling& coupling : couplings) {
      if (coupling.offset == offset) return coupling;
    }
    return couplings.emplace_back(Coupling{offset, size});
  };
  Mat3 h_landmark = Mat3::Zero();
  Vec3 g_landmark = Vec3::Zero();
  for (const Factor& factor : landmark.factors) {
    const LandmarkTerm term = linearized(factor, landmark.landmark);
    h_landmark.noalias() += term.by_landmark.transpose() * term.by_landmark;
    g_landmark.noalias() += term.by_landmark.transpose() * term.residual;
    for (int i = 0; i < term.part_count; ++i) {
      const LandmarkTerm::Part& row = term.parts[i];
      g_.segment(row.offset, row.size) += (row.jacobian.transpose() * term.residual).head(row.size);
      couplingOf(row.offset, row.size).by_landmark.noalias() += row.jacobian.transpose() * term.by_landmark;
      for (int j = 0; j < term.part_count; ++j) {
        const LandmarkTerm::Part& column = term.parts[j];
        if (column.offset > row.offset) continue;
        addProduct(row.offset, row.size, column.offset, column.size,
                   row.jacobian.transpose() * column.jacobian);
      }
    }
  }

  const Mat3 inverse_root = landmarkInverseRoot(h_landmark);
  const Mat3 inverse = inverse_root * inverse_root.transpose();
  for (const Coupling& row : couplings) {
    const BlockByLandmark weighted = row.by_landmark * inverse;
    g_.segment(row.offset, row.size) -= (weighted * g_landmark).head(row.size);
    for (const Coupling& column : couplings) {
      if (column.offset > row.offset) continue;
      addProduct(row.offset, row.size, column.offset, column.size,
                 -weighted * column.by_landmark.transpose());
    }
  }
  eliminated_.push_back({landmark.landmark, inverse, g_landmark, std::move(couplings)});
}

void NormalEquations::stepLandmarks(const Eigen::VectorXd& step) const {
  for (const EliminatedLandmark& landmark : eliminated_) {
    Vec3 gradient = landmark.gradient;
    for (const Coupling& coupling : landmark.couplings) {
      gradient.noalias() += coupling.by_landmark.topRows(coupling.size).transpose() *
                            step.segment(coupling.offset, coupling.size);
    }
    Eigen::Map<Eigen::Matrix<double, kLandmarkSize, 1>> value(landmark.value);
    value -= landmark.inverse_hessian * gradient;
  }
}

void NormalEquations::forgetTerms() {
  h_.resize(0, 0);
  g_.resize(0);
}

Eigen::MatrixXd NormalEquations::hessian() const {
  Eigen::MatrixXd full = h_.topLeftCorner(size_, size_).selfadjointView<Eigen::Lower>();
  return full;
}

}  // namespace lodeline
