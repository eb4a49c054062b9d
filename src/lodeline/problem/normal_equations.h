#pragma once

#include <Eigen/Core>
#include <vector>

#include "lodeline/problem/factor_builder.h"

namespace lodeline {

/// W with W W^T the inverse of a landmark's positive semi-definite Hessian on its range, independent of the
/// units of its coordinates. Directions with negligible information count as unobserved and give zero.
Mat3 landmarkInverseRoot(const Mat3& hessian);

/// Gauss-Newton system H d = -g of some factors over an ordered list of blocks, landmarks eliminated.
/// Jacobians are those of the factors (at linearization points where they have them); residuals are current.
class NormalEquations {
 public:
  struct Block {
    double* value = nullptr;
    int ambient_size = 0;
    int offset = 0;  ///< first row in the system

    int tangentSize() const { return ambient_size == kPoseSize ? kPoseTangentSize : ambient_size; }
  };

  /// Adds a factor. Its new blocks get their rows in the order in which they first appear.
  void add(const Factor& factor);

  /// Adds the terms of one landmark and eliminates it (Schur complement). Apart from the landmark, its
  /// factors may have blocks of at most kMostCoordinates tangent coordinates.
  void addEliminated(const LandmarkFactors& landmark);

  /// Adds 1/2 d^T h d + g^T d, where d stacks the tangent coordinates of `blocks`, each at its offset; only
  /// the lower triangle of h is read.
  void add(const std::vector<Block>& blocks, const Eigen::MatrixXd& h, const Eigen::VectorXd& g);

  /// Reserves memory for this number of tangent coordinates.
  void reserve(int size);

  /// Updates the eliminated landmarks for a step d of the blocks.
  void stepLandmarks(const Eigen::VectorXd& step) const;

  /// Frees the system except for the data of stepLandmarks().
  void forgetTerms();

  const std::vector<Block>& blocks() const { return blocks_; }
  int size() const { return size_; }
  const Block* find(const double* value) const;

  /// Symmetric, size() x size().
  Eigen::MatrixXd hessian() const;
  /// The Hessian with undefined entries above its diagonal; invalid after the next change.
  Eigen::Block<const Eigen::MatrixXd> lowerTriangle() const { return h_.topLeftCorner(size_, size_); }
  const Eigen::VectorXd gradient() const { return g_.head(size_); }

 private:
  static constexpr int kMostCoordinates = 10;  ///< of a block of a landmark's factors
  using BlockByLandmark = Eigen::Matrix<double, kMostCoordinates, 3>;
  using Product = Eigen::Matrix<double, kMostCoordinates, kMostCoordinates>;
  struct LandmarkTerm;
  /// Hessian block between a block and the landmark; rows beyond the block's size are zero.
  struct Coupling {
    int offset, size;
    BlockByLandmark by_landmark = BlockByLandmark::Zero();
  };
  /// Data for back-substitution.
  struct EliminatedLandmark {
    double* value;
    Mat3 inverse_hessian;
    Vec3 gradient;
    std::vector<Coupling> couplings;
  };
  int offsetOf(double* value, int ambient_size);
  LandmarkTerm linearized(const Factor& factor, const double* landmark);
  void addProduct(int row, int row_size, int column, int column_size, const Product& product);

  std::vector<Block> blocks_;
  std::vector<EliminatedLandmark> eliminated_;
  Eigen::MatrixXd h_;  ///< lower triangle is kept; may be larger than size_
  Eigen::VectorXd g_;
  int size_ = 0;
};

}  // namespace lodeline
