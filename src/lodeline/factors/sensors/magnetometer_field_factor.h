#pragma once

#include <ceres/cost_function.h>

#include <vector>

#include "lodeline/factors/parameters.h"
#include "lodeline/types.h"

namespace lodeline {

/// Standard deviations of one frame's mean field.
struct FieldNoise {
  double sigma_T = 0.0;  ///< per axis, independent from frame to frame
  double rotation_sigma_rad =
      0.0;  ///< of the rotation that carried the readings to the time of the frame, per axis
  double tilt_sigma_rad = 0.0;  ///< of the roll and pitch in the attitude, which the factor does not estimate
};

/// Mean magnetometer reading of one frame compared with the field of the world: 3 residuals. Blocks:
/// pose (7), field m_W (3, T), offset o_B (3, T). Where there are any, disturbance d_W (3, T) and fields
/// k_i of electric currents (3 each, T/A, body axes) follow:
///
///   e = Rz R_ref (z_B - C (o_B + sum_i k_i I_i)) - m_W - d_W     T, world axes
///   Rz = exp(psi e_z),  psi = e_z . log(R_W_B R_ref^-1)          rad
///
/// z_B is the mean reading and C the mean rotation that carried its readings (MagnetometerMean), I_i are the
/// mean currents at the readings (A). R_ref is an
/// attitude close to R_W_B. The factor informs only the heading of the pose: roll and pitch are those of
/// R_ref, so no disturbance of the field can tilt gravity. All three components inform m_W, o_B and d_W. Only
/// the component of the residual across the horizontal field, (e_z x m_W) / |e_z x m_W|, informs the heading.
///
/// Covariance, world axes, with [m] the skew matrix of m_W + d_W at construction and P = diag(1, 1, 0):
///   sigma^2 I + rotation_sigma^2 [m][m]^T + tilt_sigma^2 [m] P [m]^T.
/// The last term is the effect of an error in the roll or pitch of R_ref.
///
/// A yaw of the world that rotates poses, m_W and d_W together does not change the residual. The factor ties
/// the heading to m_W, so other terms have to determine the direction of m_W. The linearization points of the
/// pose (which are R_ref too) are as in factors/parameters.h, that of m_W is as given. The residual is linear
/// in o_B, k_i and d_W. Derivation: docs/theory/magnetometer.md.
class MagnetometerFieldFactor final : public ceres::CostFunction {
 public:
  /// `reference` is R_ref. `first_pose`, `first_field` (T): linearization points; null for the current
  /// values. `currents_A`: I_i; the blocks k_i come last. Throws InputError for readings or noise that are
  /// not finite, and for a sigma_T that is not positive.
  MagnetometerFieldFactor(const Vec3& mean_B, const Mat3& carried, const Quat& reference, const Vec3& field_W,
                          const FieldNoise& noise, bool disturbed, const double* first_pose = nullptr,
                          const double* first_field = nullptr, std::vector<double> currents_A = {});

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Vec3 mean_B_;
  Mat3 carried_;
  Quat reference_;
  Mat3 whitening_;
  bool disturbed_;
  const double* first_pose_;
  const double* first_field_;
  std::vector<double> currents_A_;
};

/// Angle psi (rad) of the rotation from `reference` to `rotation` (both R_W_B) about the vertical.
double headingBetween(const Quat& reference, const Quat& rotation);

/// Covariance of the field factor's residual before whitening, T^2, world axes.
Mat3 fieldCovariance_W(const Vec3& field_W, const FieldNoise& noise);

}  // namespace lodeline
