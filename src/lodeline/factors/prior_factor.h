#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <vector>

#include "lodeline/factors/parameters.h"

namespace lodeline {

/// Marginalization prior: a quadratic cost over some parameter blocks around their linearization points,
///   cost(x) = 1/2 || J d + e ||^2,   d = x (-) linearization point, stacked over the blocks in order.
/// The difference of pose blocks is perturbationBetween(), that of other blocks is subtraction. J is square
/// and upper triangular.
struct Prior {
  struct Block {
    double* value = nullptr;  ///< current value of the block; owned by the window
    Eigen::VectorXd linearization_point;

    bool isPose() const { return linearization_point.size() == kPoseSize; }
    int tangentSize() const {
      return isPose() ? kPoseTangentSize : static_cast<int>(linearization_point.size());
    }
  };
  std::vector<Block> blocks;
  Eigen::MatrixXd sqrt_information;  ///< J
  Eigen::VectorXd offset;            ///< e
  Eigen::MatrixXd information;       ///< J^T J where it is already computed, else empty

  /// Adds a block with the given standard deviations (one per tangent coordinate) around its present value,
  /// independent of the other blocks.
  void append(double* value, int size, const Eigen::VectorXd& sigmas);

  bool empty() const { return blocks.empty(); }
  int tangentSize() const;

  /// d at the given block values (one pointer per block).
  Eigen::VectorXd difference(double const* const* values) const;
};

/// The prior as a factor: residual r = J d + e. Its Jacobian J is constant because it belongs to the
/// linearization points. The prior must outlive the factor.
class PriorFactor final : public ceres::CostFunction {
 public:
  explicit PriorFactor(const Prior& prior);
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const Prior& prior_;
};

}  // namespace lodeline
