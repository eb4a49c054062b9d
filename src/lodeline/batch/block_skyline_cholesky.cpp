#include "lodeline/batch/block_skyline_cholesky.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace lodeline {

BlockSkylineCholesky::BlockSkylineCholesky(const std::vector<int>& sizes, std::vector<int> first)
    : offsets_(1, 0), first_(std::move(first)) {
  for (const int size : sizes) offsets_.push_back(offsets_.back() + size);
  for (int row = 0; row < blocks(); ++row)
    rows_.emplace_back(blockSize(row), offset(row + 1) - offset(this->first(row)));
}

size_t BlockSkylineCholesky::bytes() const {
  size_t entries = 0;
  for (const Eigen::MatrixXd& row : rows_) entries += static_cast<size_t>(row.size());
  return entries * sizeof(double);
}

void BlockSkylineCholesky::setZero() {
  for (Eigen::MatrixXd& row : rows_) row.setZero();
}

Eigen::Block<Eigen::MatrixXd> BlockSkylineCholesky::block(int row, int column) {
  return rows_[static_cast<size_t>(row)].block(0, offset(column) - offset(first(row)), blockSize(row),
                                               blockSize(column));
}

Eigen::Block<const Eigen::MatrixXd> BlockSkylineCholesky::block(int row, int column) const {
  return span(row, column, column + 1);
}

Eigen::Block<const Eigen::MatrixXd> BlockSkylineCholesky::span(int row, int begin, int end) const {
  return rows_[static_cast<size_t>(row)].block(0, offset(begin) - offset(first(row)), blockSize(row),
                                               offset(end) - offset(begin));
}

void BlockSkylineCholesky::damp(double damping) {
  for (int row = 0; row < blocks(); ++row) block(row, row).diagonal() *= 1.0 + damping;
}

bool BlockSkylineCholesky::factorize() {
  for (int row = 0; row < blocks(); ++row) {
    for (int column = first(row); column < row; ++column) {
      const int begin = std::max(first(row), first(column));
      Eigen::Block<Eigen::MatrixXd> entry = block(row, column);
      if (begin < column)
        entry.noalias() -= span(row, begin, column) * span(column, begin, column).transpose();
      const Eigen::MatrixXd root = block(column, column);
      root.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(entry);
    }
    Eigen::MatrixXd diagonal = block(row, row);
    diagonal.noalias() -= span(row, first(row), row) * span(row, first(row), row).transpose();
    const Eigen::LLT<Eigen::MatrixXd> factorized(diagonal);
    if (factorized.info() != Eigen::Success) return false;
    block(row, row) = factorized.matrixL();
  }
  return true;
}

Eigen::VectorXd BlockSkylineCholesky::solve(const Eigen::VectorXd& b) const {
  Eigen::VectorXd x = b;
  for (int row = 0; row < blocks(); ++row) {
    auto part = x.segment(offset(row), blockSize(row));
    const int width = offset(row) - offset(first(row));
    part -= span(row, first(row), row) * x.segment(offset(first(row)), width);
    block(row, row).triangularView<Eigen::Lower>().solveInPlace(part);
  }
  for (int row = blocks() - 1; row >= 0; --row) {
    auto part = x.segment(offset(row), blockSize(row));
    const Eigen::MatrixXd root = block(row, row);
    root.triangularView<Eigen::Lower>().transpose().solveInPlace(part);
    const int width = offset(row) - offset(first(row));
    x.segment(offset(first(row)), width) -= span(row, first(row), row).transpose() * part;
  }
  return x;
}

void BlockSkylineCholesky::invert() {
  std::vector<std::vector<int>> below(first_.size());
  for (int row = 0; row < blocks(); ++row) {
    for (int column = first(row); column < row; ++column) below[static_cast<size_t>(column)].push_back(row);
  }
  for (int column = blocks() - 1; column >= 0; --column)
    invertColumn(column, below[static_cast<size_t>(column)]);
}

/// Computes one column of Z = A^-1, with the columns after j already computed:
///   Z_ij = -(sum over k > j of Z_ik L_kj) L_jj^-1,  Z_jj = L_jj^-T L_jj^-1 - (sum of Z_kj^T L_kj) L_jj^-1.
void BlockSkylineCholesky::invertColumn(int column, const std::vector<int>& below) {
  const int size = blockSize(column);
  const Eigen::MatrixXd inverse_root =
      block(column, column).triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(size, size));
  std::vector<Eigen::MatrixXd> scaled;  // L_kj L_jj^-1
  for (const int k : below) scaled.emplace_back(block(k, column) * inverse_root);
  std::vector<Eigen::MatrixXd> entries;
  for (const int i : below) entries.emplace_back(Eigen::MatrixXd::Zero(blockSize(i), size));
  for (size_t a = 0; a < below.size(); ++a) {
    for (size_t b = 0; b < a; ++b) {
      // Two rows that extend to this column have their common block within the skyline.
      const auto between = block(below[a], below[b]);
      entries[a].noalias() -= between * scaled[b];
      entries[b].noalias() -= between.transpose() * scaled[a];
    }
    entries[a].noalias() -= block(below[a], below[a]) * scaled[a];
  }
  Eigen::MatrixXd diagonal = inverse_root.transpose() * inverse_root;
  for (size_t a = 0; a < below.size(); ++a) {
    diagonal.noalias() -= entries[a].transpose() * scaled[a];
    block(below[a], column) = entries[a];
  }
  block(column, column) = diagonal;
}

}  // namespace lodeline
