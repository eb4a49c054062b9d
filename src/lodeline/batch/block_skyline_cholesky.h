#pragma once

#include <Eigen/Core>
#include <vector>

namespace lodeline {

/// A symmetric positive definite matrix of blocks, of which each block row is kept from its first entry up to
/// the diagonal (the skyline, or envelope). Factors of a Cholesky decomposition and those blocks of the
/// inverse that lie within the skyline need no more room than that (George & Liu, "Computer solution of large
/// sparse positive definite systems", 1981, chapter 4; Takahashi, Fagan & Chin, 1973). With states in order
/// of time, and what all of them share at the end, time and memory grow linearly with the number of states.
class BlockSkylineCholesky {
 public:
  /// `sizes` of the block rows; `first` block column that each of them has, at most its own number.
  BlockSkylineCholesky(std::vector<int> sizes, std::vector<int> first);

  int size() const { return offsets_.back(); }
  int blocks() const { return static_cast<int>(first_.size()); }
  int offset(int block) const { return offsets_[static_cast<size_t>(block)]; }
  int blockSize(int block) const { return offset(block + 1) - offset(block); }
  /// Bytes that the entries take.
  size_t bytes() const;

  void setZero();
  /// Block (row, column) with column <= row, within the skyline.
  Eigen::Block<Eigen::MatrixXd> block(int row, int column);
  Eigen::Block<const Eigen::MatrixXd> block(int row, int column) const;
  /// Multiplies the diagonal by 1 + damping.
  void damp(double damping);

  /// Replaces the matrix A by L with L L^T = A. False where A is not positive definite; it is lost then.
  bool factorize();
  /// A^-1 b, after factorize().
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// Replaces L by the blocks of A^-1 within the skyline.
  void invert();

 private:
  int first(int row) const { return first_[static_cast<size_t>(row)]; }
  /// The part of a block row over block columns [begin, end).
  Eigen::Block<const Eigen::MatrixXd> span(int row, int begin, int end) const;
  void invertColumn(int column, const std::vector<int>& below);

  std::vector<int> offsets_;
  std::vector<int> first_;
  std::vector<Eigen::MatrixXd> rows_;
};

}  // namespace lodeline
