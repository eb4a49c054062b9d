#pragma once

#include <vector>

#include "lodeline/problem/state/factor.h"
#include "lodeline/types.h"

namespace lodeline {

/// How the best position of a landmark follows the other blocks of its terms, at their present values: the
/// landmark's position given these blocks has the covariance P = H_ll^-1 and the derivative
/// dl / dx = -P H_lx.
struct LandmarkResponse {
  struct Gain {
    double* block = nullptr;
    int ambient_size = 0;
    Eigen::Matrix<double, 3, Eigen::Dynamic> by_block;  ///< by its tangent coordinates
  };
  double* landmark = nullptr;
  Mat3 covariance = Mat3::Zero();
  std::vector<Gain> gains;
};

/// From the reprojection terms of a landmark, under their losses.
LandmarkResponse responseOf(const LandmarkFactors& terms);

/// A factor on landmarks, after these are eliminated together with their reprojection terms. e is the
/// factor's whitened residual, J_l and J_x are its derivatives. The landmarks' responses give
///   e' = e / s,   J' = (J_x + sum J_l dl/dx) / s,   s^2 = 1 + share * sum J_l P J_l^T.
/// This is the Schur complement of the landmarks: for one such factor, reprojection terms without landmarks
/// and the factor (e', J') have the same Hessian as all terms with the landmarks eliminated. Factors that
/// share landmarks have correlated errors; `share` says how many of them count as one.
///
/// Blocks: those of the responses and of the factor, without the landmarks. The landmarks' values are read
/// where they are, and the responses are constants.
class EliminatedLandmarksFactor final : public ceres::CostFunction {
 public:
  /// `factor.function` must have one residual. All its landmark blocks need a response.
  EliminatedLandmarksFactor(Factor factor, std::vector<LandmarkResponse> responses, double share);

  /// In the order of the parameters.
  const std::vector<double*>& blocks() const { return blocks_; }
  /// Variance of the whitened residual with the landmarks' errors.
  double variance() const { return scale_ * scale_; }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  size_t indexOf(double* block, int size);
  /// Evaluates the factor: its residual and, unless null, its derivatives by each of its blocks.
  double evaluate(double const* const* parameters, std::vector<RowMajor>* derivatives) const;

  Factor factor_;
  std::vector<LandmarkResponse> responses_;
  std::vector<double*> blocks_;
  // Of each block of the factor: its response, null where it is no landmark, and otherwise its index among
  // `blocks_`.
  std::vector<const LandmarkResponse*> response_of_;
  std::vector<size_t> index_of_;
  double scale_ = 1.0;
};

}  // namespace lodeline
