#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Pose of the newest frame from its image alone.
struct ImagePose {
  Rigid3 world_from_body;
  /// Covariance of [dp, dtheta] in world axes, relative to the landmarks of the window.
  Mat6 covariance = Mat6::Zero();
  int landmarks = 0;  ///< observed by camera 0
  int agreeing = 0;   ///< of these, number that agree with this pose
};

/// Resection of the newest frame with respect to the window's landmarks, which are held. The result minimizes
/// a robust sum of camera 0's reprojection residuals, from the best of some start values. Inertial readings
/// are used only for the few milliseconds of the cameras' time offset. Empty where landmarks are too few or
/// too scattered: most of them must agree with one pose.
std::optional<ImagePose> poseByImages(const Window& window, const FactorBuilder& factors,
                                      std::span<const Rigid3> starts);

}  // namespace lodeline
