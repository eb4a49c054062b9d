#pragma once

#include <vector>

namespace lodeline {

/// Quantile of the chi-squared distribution. Throws UsageError unless 0 < probability < 1.
double chiSquaredQuantile(double probability, int degrees_of_freedom);

/// Graduated non-convexity for the truncated least squares cost sum_k min(r_k^2, c_k^2): H. Yang,
/// P. Antonante, V. Tzoumas, L. Carlone, "Graduated non-convexity for robust spatial perception", RA-L 2020.
/// A convex surrogate is solved first and becomes the truncated cost step by step, as mu rises. With
/// q_k = r_k^2 / c_k^2 the weight of residual k is
///   1 where q <= mu / (mu + 1),   0 where q >= (mu + 1) / mu,   else sqrt(mu (mu + 1) / q) - mu.
/// The weights are determined by the residuals alone and do not depend on their order.
class GraduatedWeights {
 public:
  /// `ratios`: q_k after a solution with all weights 1.
  explicit GraduatedWeights(const std::vector<double>& ratios);

  /// Weights for the present mu, which then rises.
  std::vector<double> next(const std::vector<double>& ratios);
  /// Whether the last weights were all 0 or 1.
  bool areBinary() const { return are_binary_; }

 private:
  double mu_;
  bool are_binary_ = false;
};

}  // namespace lodeline
