#pragma once

#include <Eigen/Core>
#include <optional>

#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// How the newest frame's pose by images differs from two predictions of it, world axes.
struct MotionInnovation {
  /// Of position (m) and of rotation (rad): images minus inertial prediction.
  Vec3 position_W = Vec3::Zero(), rotation_W = Vec3::Zero();
  /// Squared and normalized by covariance and dimension: 1 on average where both are as stated.
  double position_nis = 0.0, rotation_nis = 0.0;
  /// Images minus a body that keeps the mean velocity and rate between the two frames before: what images
  /// alone say of accelerations.
  Vec3 position_from_steady_W = Vec3::Zero(), rotation_from_steady_W = Vec3::Zero();
  Rigid3 world_from_body;  ///< by images
  double interval_s = 0.0;
};

/// Compares the newest frame of a window, whose state is still the inertial prediction, with its image
/// (poseByImages()). `before`: covariance of [dp, dtheta, dv, db_g, db_a] of the frame before, of which the
/// pose counts only where no image placed that frame among the landmarks (`is_before_placed`). Nothing where
/// images do not tell.
std::optional<MotionInnovation> motionInnovation(Window& window, const FactorBuilder& factors,
                                                 const Eigen::Matrix<double, 15, 15>& before,
                                                 bool is_before_placed);

}  // namespace lodeline
