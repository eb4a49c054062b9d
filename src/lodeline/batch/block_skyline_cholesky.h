#pragma once

#include <Eigen/Core>
#include <vector>

namespace lodeline {

/// Symmetric positive definite block matrix in skyline (envelope) storage: each block row is stored from its
/// first entry up to the diagonal. The Cholesky factor and the inverse's blocks within the skyline need no
/// additional memory (George & Liu, "Computer solution of large sparse positive definite systems", 1981,
/// chapter 4; Takahashi, Fagan & Chin, 1973). With states in order of time, and their shared blocks at the
/// end, time and memory grow linearly with the number of states.
class BlockSkylineCholesky {
 public:
  /// `sizes`: of the block rows; `first`: first block column of each row, at most the row's own number.
  BlockSkylineCholesky(const std::vector<int>& sizes, std::vector<int> first);

  int size() const { return offsets_.back(); }
  int blocks() const { return static_cast<int>(first_.size()); }
  int offset(int block) const { return offsets_[static_cast<size_t>(block)]; }
  int blockSize(int block) const { return offset(block + 1) - offset(block); }
  /// Memory of the entries in bytes.
  size_t bytes() const;

  /// Whether a block with column <= row is within the skyline.
  bool contains(int row, int column) const { return column >= first(row); }

  void setZero();
  /// Block (row, column) with column <= row, within the skyline.
  Eigen::Block<Eigen::MatrixXd> block(int row, int column);
  Eigen::Block<const Eigen::MatrixXd> block(int row, int column) const;
  /// Multiplies the diagonal by 1 + damping.
  void damp(double damping);

  /// Replaces the matrix A by L with L L^T = A. Returns false where A is not positive definite; A is then
  /// lost.
  bool factorize();
  /// A^-1 b, after factorize().
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// Replaces L by the blocks of A^-1 within the skyline.
  void invert();

 private:
  int first(int row) const { return first_[static_cast<size_t>(row)]; }
  /// Part of a block row over block columns [begin, end).
  Eigen::Block<const Eigen::MatrixXd> span(int row, int begin, int end) const;
  void invertColumn(int column, const std::vector<int>& below);

  std::vector<int> offsets_;
  std::vector<int> first_;
  std::vector<Eigen::MatrixXd> rows_;
};

}  // namespace lodeline
