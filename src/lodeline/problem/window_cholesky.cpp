#include "lodeline/problem/window_cholesky.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "lodeline/problem/simd_gemm.h"

namespace lodeline {
namespace {

/// Number of columns eliminated together in the dense part.
constexpr int kDenseColumns = 24;

}  // namespace

WindowCholesky::WindowCholesky(const NormalEquations& system, const std::vector<const double*>& first,
                               const std::vector<const double*>& last) {
  std::vector<bool> placed(static_cast<size_t>(system.size()), false);
  const auto rowsOf = [&](const std::vector<const double*>& blocks, std::vector<int>* rows) {
    for (const double* value : blocks) {
      const NormalEquations::Block& block = *system.find(value);
      for (int row = block.offset; row < block.offset + block.tangentSize(); ++row) {
        rows->push_back(row);
        placed[static_cast<size_t>(row)] = true;
      }
    }
  };
  std::vector<int> at_the_end;
  rowsOf(last, &at_the_end);
  last_size_ = static_cast<int>(at_the_end.size());
  rowsOf(first, &order_);
  for (const double* value : first) sizes_.push_back(system.find(value)->tangentSize());
  for (int row = static_cast<int>(order_.size()); row < system.size(); row += kDenseColumns)
    sizes_.push_back(std::min(kDenseColumns, system.size() - row));
  for (int row = 0; row < system.size(); ++row) {
    if (!placed[static_cast<size_t>(row)]) order_.push_back(row);
  }
  order_.insert(order_.end(), at_the_end.begin(), at_the_end.end());

  const auto h = system.lowerTriangle();
  scale_ = h.diagonal().cwiseMax(1e-12).cwiseSqrt().cwiseInverse()(order_);
  const Eigen::Index size = h.rows();
  ordered_.resize(size, size);
  for (Eigen::Index column = 0; column < size; ++column) {
    const int b = order_[static_cast<size_t>(column)];
    for (Eigen::Index row = column; row < size; ++row) {
      const int a = order_[static_cast<size_t>(row)];
      ordered_(row, column) = (a >= b ? h(a, b) : h(b, a)) * scale_[row] * scale_[column];
    }
  }
}

bool WindowCholesky::factorize(double damping) {
  factor_ = ordered_;
  factor_.diagonal().array() += damping;
  int column = 0;
  for (const int size : sizes_) {
    if (!eliminate(column, size)) return false;
    column += size;
  }
  return true;
}

std::vector<WindowCholesky::Run> WindowCholesky::runsBelow(int column, int size) const {
  std::vector<Run> runs;
  for (int row = column + size; row < factor_.rows(); ++row) {
    if (factor_.row(row).segment(column, size).isZero(0.0)) continue;
    if (!runs.empty() && runs.back().row + runs.back().size == row) {
      ++runs.back().size;
    } else {
      runs.push_back({row, 1});
    }
  }
  return runs;
}

bool WindowCholesky::eliminate(int column, int size) {
  Eigen::Ref<Eigen::MatrixXd> diagonal = factor_.block(column, column, size, size);
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factorized(diagonal);
  if (factorized.info() != Eigen::Success) return false;
  const std::vector<Run> runs = runsBelow(column, size);
  for (size_t i = 0; i < runs.size(); ++i) {
    auto below = factor_.block(runs[i].row, column, runs[i].size, size);
    diagonal.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
    for (size_t j = 0; j < i; ++j) {
      subtractProduct(below, factor_.block(runs[j].row, column, runs[j].size, size),
                      factor_.block(runs[i].row, runs[j].row, runs[i].size, runs[j].size));
    }
    subtractSquare(below, factor_.block(runs[i].row, runs[i].row, runs[i].size, runs[i].size));
  }
  return true;
}

Eigen::VectorXd WindowCholesky::solve(const Eigen::VectorXd& b) const {
  Eigen::VectorXd ordered = scale_.cwiseProduct(b(order_));
  factor_.triangularView<Eigen::Lower>().solveInPlace(ordered);
  factor_.triangularView<Eigen::Lower>().transpose().solveInPlace(ordered);
  Eigen::VectorXd x(b.size());
  x(order_) = scale_.cwiseProduct(ordered);
  return x;
}

Eigen::MatrixXd WindowCholesky::covarianceOfLast() const {
  // With these rows last, their marginal information is the factor's last block.
  const Eigen::MatrixXd inverse_root = factor_.bottomRightCorner(last_size_, last_size_)
                                           .triangularView<Eigen::Lower>()
                                           .solve(Eigen::MatrixXd::Identity(last_size_, last_size_));
  const auto scale = scale_.tail(last_size_).asDiagonal();
  const Eigen::MatrixXd covariance = scale * (inverse_root.transpose() * inverse_root) * scale;
  return 0.5 * (covariance + covariance.transpose());
}

std::vector<const double*> motionsButTheNewest(const Window& window) {
  std::vector<const double*> motions;
  for (const auto& frame : window.frames()) {
    if (frame->has_motion && frame.get() != &window.newest()) motions.push_back(frame->motion.data());
  }
  return motions;
}

}  // namespace lodeline
