#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// The newest frame's pose by its image alone.
struct ImagePose {
  Rigid3 world_from_body;
  /// Of [dp, dtheta] in world axes, against the landmarks of the window.
  Mat6 covariance = Mat6::Zero();
  int landmarks = 0;  ///< seen by camera 0
  int agreeing = 0;   ///< of which lie where this pose has them
};

/// Resection of the newest frame against the window's landmarks, which are held: the pose that minimizes a
/// robust sum of camera 0's reprojection errors, from the best of some starts. No inertial reading takes part
/// but for the few milliseconds of the cameras' time offset. Nothing where landmarks are too few or too
/// scattered: most of them must agree with one pose.
std::optional<ImagePose> poseByImages(const Window& window, const FactorBuilder& factors,
                                      std::span<const Rigid3> starts);

}  // namespace lodeline
