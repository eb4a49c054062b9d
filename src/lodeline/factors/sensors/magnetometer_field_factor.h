#pragma once

#include <ceres/cost_function.h>

#include "lodeline/factors/parameters.h"
#include "lodeline/geometry/rigid3.h"

namespace lodeline {

/// How well one frame's mean field is known.
struct FieldNoise {
  double sigma_T = 0.0;             ///< per axis, independent from frame to frame
  double rotation_sigma_rad = 0.0;  ///< of the rotation that carried the readings to the frame, per axis
  double tilt_sigma_rad = 0.0;      ///< of the attitude's roll and pitch, which the factor takes as given
};

/// One frame's mean magnetometer reading against the field of the world, 3 residuals on the blocks pose (7),
/// field m_W (3, T), offset o_B (3, T) and, where there is one, disturbance d_W (3, T):
///
///   e = Rz R_ref (z_B - C o_B) - m_W - d_W                       T, world axes
///   Rz = exp(psi e_z),  psi = e_z . log(R_W_B R_ref^-1)          rad
///
/// z_B is the mean, C the mean rotation that carried its readings (MagnetometerMean), R_ref an attitude close
/// to R_W_B. So the factor sees the heading of the pose and nothing else of it: its roll and pitch are those
/// of R_ref, and no disturbance of the field can tilt gravity. All three components inform m_W, o_B and d_W;
/// of the residual only the part across the horizontal field, (e_z x m_W) / |e_z x m_W|, informs the heading.
///
/// Covariance, world axes, with [m] the skew matrix of m_W + d_W at construction and P = diag(1, 1, 0):
///   sigma^2 I + rotation_sigma^2 [m][m]^T + tilt_sigma^2 [m] P [m]^T,
/// the last term being what a wrong roll or pitch of R_ref does to the residual.
///
/// A yaw of the world that turns poses, m_W and d_W together changes nothing: heading is anchored to m_W, and
/// m_W has to get its direction from elsewhere. First estimates of the pose as in factors/parameters.h (they
/// are R_ref too), of m_W as given; the residual is linear in o_B and d_W.
/// Derivation: docs/magnetometer.md.
class MagnetometerFieldFactor final : public ceres::CostFunction {
 public:
  /// `reference` is R_ref. `first_pose`, `first_field` (T): where the Jacobian is taken; null for the current
  /// values. Throws InputError for readings or noise that are not finite, or noise without positive sigma_T.
  MagnetometerFieldFactor(const Vec3& mean_B, const Mat3& carried, const Quat& reference, const Vec3& field_W,
                          const FieldNoise& noise, bool disturbed, const double* first_pose = nullptr,
                          const double* first_field = nullptr);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Vec3 mean_B_;
  Mat3 carried_;
  Quat reference_;
  Mat3 whitening_;
  bool disturbed_;
  const double* first_pose_;
  const double* first_field_;
};

/// The angle psi by which `rotation` (R_W_B) is turned about the vertical against `reference`.
double headingBetween(const Quat& reference, const Quat& rotation);

/// Covariance of the field factor's residual before whitening, T^2, world axes.
Mat3 fieldCovariance_W(const Vec3& field_W, const FieldNoise& noise);

}  // namespace lodeline
