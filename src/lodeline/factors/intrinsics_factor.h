#pragma once

#include <ceres/cost_function.h>

#include <memory>

#include "lodeline/factors/reprojection_factor.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

// Parameter block of a camera's lens, all zero where the calibration file is right:
//   intrinsics  [s_u, s_v, c_u, c_v, k_1, k_2]: relative change of both focal lengths, shift of the principal
//               point (px), change of the radial profile.
// A ray at the angle theta off the axis, which the file puts at the pixel u, is seen at
//   u + diag(s_u, s_v) (u - c) + [c_u, c_v] + (k_1 sin^2 theta + k_2 sin^4 theta) (u - c)
// with the file's principal point c: to first order any error of a pinhole with radial distortion, whatever
// the model of the lens.

constexpr int kIntrinsicsSize = 6;

/// d(residual) / d(intrinsics) of a sighting, a constant: the residual is the pixel error over sigma, so a
/// lens that shows the ray elsewhere adds to it.
Eigen::Matrix<double, 2, kIntrinsicsSize> residualByIntrinsics(const DirectionMeasurement& measurement);

/// A calibration file's lens with an intrinsics block put in, in its own model (which becomes
/// radial-tangential where it had no distortion): exact for the pinhole part, to the fourth power of the
/// angle for the profile.
CameraCalibration correctedLens(const CameraCalibration& file, const double* intrinsics);

/// Another reprojection factor of two residuals, with the intrinsics of the camera that made the sighting as
/// one block more, the last.
class IntrinsicsFactor final : public ceres::CostFunction {
 public:
  IntrinsicsFactor(std::unique_ptr<ceres::CostFunction> factor, const DirectionMeasurement& measurement);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  std::unique_ptr<ceres::CostFunction> factor_;
  Eigen::Matrix<double, 2, kIntrinsicsSize> by_intrinsics_;
};

}  // namespace lodeline
