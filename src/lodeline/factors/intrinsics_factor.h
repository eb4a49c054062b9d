#pragma once

#include <ceres/cost_function.h>

#include <memory>

#include "lodeline/factors/reprojection_factor.h"
#include "lodeline/rig.h"

namespace lodeline {

// Parameter block of the intrinsics of a camera, all zero where the calibration file is right:
//   intrinsics  [s_u, s_v, c_u, c_v, k_1, k_2, p_1, p_2, q_1, q_2]: relative change of both focal lengths,
//               shift of the principal point (px), change of two radial and two tangential coefficients, and
//               two coefficients of a tilted port.
// Let p be the position of a ray in the RadialPlane of the camera model (DirectionMeasurement::in_plane). Let
// u be the pixel at which the intrinsics of the file project the ray. The corrected intrinsics project
// it at the following pixel, with the principal point c of the file and its focal lengths f on the axis:
//   u + diag(s_u, s_v) (u - c) + [c_u, c_v] + diag(f_u, f_v) d(p)
//   d(p) = (k_1 |p|^2 + k_2 |p|^4) p + |p|^2 t + 2 p (t^T p) + |p|^2 (|p|^2 q + 1.5 p (q^T p))
//   t = [p_2, p_1], q = [q_1, q_2]
// This is the first-order effect of different numbers in the file; the last term is what a tilt of a
// flat port adds (docs/theory/ports.md). Powers of the sine of the angle, in place of p, would leave 0.3
// px at the border for errors of 0.006 in the coefficients. Their signs would be opposite on opposite
// sides. The focal length would absorb that error.

constexpr int kIntrinsicsSize = 10;

/// Effect of an intrinsics block on the residual of one observation.
struct IntrinsicsEffect {
  Vec2 shift;  ///< to be added to the residual by the file's intrinsics, sigmas
  Eigen::Matrix<double, 2, kIntrinsicsSize> by_intrinsics;  ///< d(shift)
  Mat2 by_residual;  ///< d(residual + shift) / d(residual by the file's intrinsics)
};

/// Effect of the intrinsics block on an observation whose residual with the file's intrinsics is `residual`.
/// The shift is evaluated at the pixel where the point is predicted, not at the pixel where it was observed.
/// The observed pixel contains the noise of the residual. Noise in both the residual and its derivative would
/// bias every observation towards a longer focal length: by 0.3 % for half a pixel, twenty sigmas of a dive
/// (camera_states_test.cpp).
IntrinsicsEffect intrinsicsEffect(const DirectionMeasurement& measurement, const Vec2& residual,
                                  const double* intrinsics);

/// Only the shift of intrinsicsEffect().
Vec2 intrinsicsShift(const DirectionMeasurement& measurement, const Vec2& residual, const double* intrinsics);

/// Unit ray of an observation's pixel by the intrinsics of the file corrected by an intrinsics block.
/// DirectionMeasurement::bearing_C is the ray by the file alone.
Vec3 rayThrough(const DirectionMeasurement& measurement, const double* intrinsics);

/// The calibration of a file with an intrinsics block applied, in the camera model of the file. Where the
/// model has no coefficients k_1 and k_2, its parameters are fitted to the corrected pixels. A pinhole camera
/// becomes radial-tangential where the block changes a radial coefficient.
CameraCalibration correctedIntrinsics(const CameraCalibration& file, const double* intrinsics);

/// Adds the intrinsics block of the observing camera to another reprojection factor with two residuals. The
/// block is the last one. Residual r = r_file + shift(r_file, intrinsics), in sigmas, where r_file is the
/// residual of the other factor (intrinsicsEffect()).
class IntrinsicsFactor final : public ceres::CostFunction {
 public:
  IntrinsicsFactor(std::unique_ptr<ceres::CostFunction> factor, const DirectionMeasurement& measurement);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  std::unique_ptr<ceres::CostFunction> factor_;
  DirectionMeasurement measurement_;
};

}  // namespace lodeline
