#pragma once

#include <ceres/sized_cost_function.h>

#include "lodeline/factors/parameters.h"
#include "lodeline/types.h"

namespace lodeline {

/// Magnetometer reading of one frame compared with the field that a map predicts at its place: 3 residuals on
/// the blocks pose (7) and heading h of the map (1, rad):
///
///   e = Rz R_ref z_B - exp(h e_z) T_M          T, world axes
///   Rz = exp(psi e_z),  psi = e_z . log(R_W_B R_ref^-1)
///
/// z_B is the reading without hard iron and currents. T_M is the whole field by the map, in axes of the map:
/// the world as it was turned when the map began. R_ref is an attitude close to R_W_B. As in the
/// MagnetometerFieldFactor, the reading informs the heading alone: neither tilt nor position. The covariance
/// of the prediction has to contain the error of the position. A yaw of the world that turns poses and h
/// together does not change the residual. So the factor ties a heading to the heading at which the map was
/// learnt. The linearization points are as in factors/parameters.h. Derivation: docs/theory/magnetic-map.md.
class MagnetometerMapFactor final : public ceres::SizedCostFunction<3, kPoseSize, 1> {
 public:
  /// `covariance_W`: of reading and prediction, T^2. `first_pose`, `first_heading`: linearization points;
  /// null for the current values. Throws InputError for values that are not finite, and for a covariance that
  /// is not positive definite.
  MagnetometerMapFactor(const Vec3& reading_B, const Vec3& mapped_M, const Mat3& covariance_W,
                        const Quat& reference, const double* first_pose = nullptr,
                        const double* first_heading = nullptr);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Vec3 reading_B_, mapped_M_;
  Mat3 whitening_;
  Quat reference_;
  const double* first_pose_;
  const double* first_heading_;
};

}  // namespace lodeline
