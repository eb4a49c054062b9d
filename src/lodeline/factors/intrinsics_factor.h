#pragma once

#include <ceres/cost_function.h>

#include <memory>

#include "lodeline/factors/reprojection_factor.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

// Parameter block of a camera's lens, all zero where the calibration file is right:
//   intrinsics  [s_u, s_v, c_u, c_v, k_1, k_2]: relative change of both focal lengths, shift of the principal
//               point (px), change of the first two radial coefficients.
// A ray that lies at p in the plane where the lens' model counts its radius (DirectionMeasurement::in_plane),
// and that the file puts at the pixel u, is seen at
//   u + diag(s_u, s_v) (u - c) + [c_u, c_v] + (k_1 |p|^2 + k_2 |p|^4) diag(f_u, f_v) p
// with the file's principal point c and focal lengths f: to first order what other numbers in the file would
// make of it. Powers of the sine would leave 0.3 px at the border for errors of 0.006 in the coefficients, to
// opposite sides, and the focal length would take them up.

constexpr int kIntrinsicsSize = 6;

/// What a lens does to an observation.
struct IntrinsicsEffect {
  Vec2 shift;  ///< to add to the residual by the file's lens, sigmas
  Eigen::Matrix<double, 2, kIntrinsicsSize> by_intrinsics;  ///< d(shift)
  Mat2 by_residual;                                         ///< d(residual + shift) / d(residual by the file)
};

/// Where the file's lens leaves `residual` of an observation. The shift is taken where the point should be
/// seen, not where it was: the noise of an observation is in its residual, and with the noise of its place in
/// the derivative their product would speak for a longer lens in every observation (by 0.3 % for half a
/// pixel, twenty sigmas of a dive; camera_states_test.cpp).
IntrinsicsEffect intrinsicsEffect(const DirectionMeasurement& measurement, const Vec2& residual,
                                  const double* intrinsics);

/// IntrinsicsEffect::shift alone.
Vec2 intrinsicsShift(const DirectionMeasurement& measurement, const Vec2& residual, const double* intrinsics);

/// The ray of an observation that a lens with an intrinsics block put in makes of its pixel, where
/// DirectionMeasurement::bearing_C is what the file makes of it.
Vec3 rayThrough(const DirectionMeasurement& measurement, const double* intrinsics);

/// A calibration file's lens with an intrinsics block put in, in its own model (which becomes
/// radial-tangential where it had no distortion).
CameraCalibration correctedIntrinsics(const CameraCalibration& file, const double* intrinsics);

/// Another reprojection factor of two residuals, with the intrinsics of the camera that made the observation
/// as one block more, the last.
class IntrinsicsFactor final : public ceres::CostFunction {
 public:
  IntrinsicsFactor(std::unique_ptr<ceres::CostFunction> factor, const DirectionMeasurement& measurement);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  std::unique_ptr<ceres::CostFunction> factor_;
  DirectionMeasurement measurement_;
};

}  // namespace lodeline
