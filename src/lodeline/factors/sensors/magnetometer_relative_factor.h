#pragma once

#include <ceres/sized_cost_function.h>

#include "lodeline/factors/parameters.h"

namespace lodeline {

/// The magnetometer term of the paper between two frames, as printed. For every reading j of the interval (k,
/// k+1], with the preintegrated rotation dR_k^j = gamma_k^j,
///
///   e[j,k] = R_B_W^k R_W_B^{k+1} m^{k+1} - dR_k^j m^j            T, axes of body k
///
/// whitened by the sensor's noise alone, covariance sigma^2 I (paper section III-D). Blocks: pose k, pose
/// k+1.
///
/// All n residuals of an interval share their first term a and have the same Jacobian. The sum of their
/// squares is
///   sum_j |a - b_j|^2 = n |a - mean(b)|^2 + const,
/// The 3 residuals sqrt(n)/sigma (a - mean(b)) therefore give the same cost with a fraction of the work.
/// The rotations dR use the current gyroscope bias: the readings do not inform that bias.
///
/// Limits of this form: m^{k+1} is one noisy reading, but n residuals count it as n independent ones. The
/// errors of consecutive intervals do not cancel. Heading drifts as without a magnetometer, and the
/// covariance does not show this drift (docs/theory/magnetometer.md).
class MagnetometerRelativeFactor final : public ceres::SizedCostFunction<3, kPoseSize, kPoseSize> {
 public:
  /// `newest_B`: m^{k+1}, axes of body k+1; `mean_Bk`: mean over j of dR_k^j m^j, axes of body k; T.
  /// `sigma_T`: of one reading, positive. `first_pose_k`, `first_pose_k1`: linearization points as in
  /// factors/parameters.h.
  MagnetometerRelativeFactor(const Vec3& newest_B, const Vec3& mean_Bk, int readings, double sigma_T,
                             const double* first_pose_k = nullptr, const double* first_pose_k1 = nullptr);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Vec3 newest_B_;
  Vec3 mean_Bk_;
  double weight_;  ///< 1/T
  const double* first_pose_k_;
  const double* first_pose_k1_;
};

}  // namespace lodeline
