#pragma once

#include <Eigen/Core>
#include <optional>

#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// Difference of the newest frame's pose by images from two predictions of it, world axes.
struct MotionInnovation {
  /// Position (m) and rotation (rad): images minus inertial prediction.
  Vec3 position_W = Vec3::Zero(), rotation_W = Vec3::Zero();
  /// Normalized innovation squared, per dimension: 1 on average where both covariances are correct.
  double position_nis = 0.0, rotation_nis = 0.0;
  /// Images minus a body that keeps the mean velocity and rate between the two frames before: the
  /// acceleration as images alone show it.
  Vec3 position_from_steady_W = Vec3::Zero(), rotation_from_steady_W = Vec3::Zero();
  Rigid3 world_from_body;  ///< by images
  double interval_s = 0.0;
};

/// Compares the newest frame of a window, whose state is still the inertial prediction, with its pose by
/// images (poseByImages()). `before`: covariance of [dp, dtheta, dv, db_g, db_a] of the frame before. Its
/// pose is used only where no image determined the pose of that frame relative to the landmarks
/// (`is_before_placed`). Empty where images do not determine a pose.
std::optional<MotionInnovation> motionInnovation(Window& window, const FactorBuilder& factors,
                                                 const Eigen::Matrix<double, 15, 15>& before,
                                                 bool is_before_placed);

}  // namespace lodeline
