#pragma once

#include <Eigen/Core>
#include <optional>

#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// A difference of two measurements with its covariance. Some causes are new in every frame, such as the
/// noise of an image; others last over many frames, such as the error of a bias or of the scale.
struct Innovation {
  Vec3 value = Vec3::Zero();
  Mat3 covariance_of_new = Mat3::Zero(), covariance_of_lasting = Mat3::Identity();

  /// Normalized innovation squared, per dimension: 1 on average where the covariances are correct.
  double nis() const;
};

/// Difference of the newest frame's pose by images from two predictions of it.
struct MotionInnovation {
  /// Images minus inertial prediction, world axes: position in m, rotation in rad.
  Innovation position_W, rotation_W;
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
