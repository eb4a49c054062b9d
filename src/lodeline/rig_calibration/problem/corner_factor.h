#pragma once

#include <ceres/cost_function.h>

#include "lodeline/rig_calibration/problem/rig_state.h"

namespace lodeline {

/// Error of one corner of the board in an image, 2 residuals in sigmas:
///
///   x_W = exp([tilt, 0]) R_level_T x_T
///   x_B = (R exp((w - b_g) d))^T (x_W - p - v d)
///   x_C = R_B_C^T (x_B - p_B_C)
///   e   = (project(x_C) - pixel) / sigma
///
/// x_B is in the body at the time of the image, which is d after that of the frame.
///
/// Blocks: pose (R, p), motion (v, b_g, b_a), body_from_camera, delay d (s), tilt (2), lens, and the port
/// where there is one. Layout and perturbations are those of factors/parameters.h. The derivative by the
/// delay is exact; that by the bias is to first order in d, which the solution makes zero.
class CornerFactor final : public ceres::CostFunction {
 public:
  /// All must outlive the factor. `camera` must have been refreshed for the values of an evaluation.
  CornerFactor(const RigState* rig, const CameraState* camera, const FrameState* frame, const Vec3& corner_T,
               const Vec2& pixel);

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const RigState* rig_;
  const CameraState* camera_;
  const FrameState* frame_;
  Vec3 corner_T_;
  Vec2 pixel_;
};

}  // namespace lodeline
