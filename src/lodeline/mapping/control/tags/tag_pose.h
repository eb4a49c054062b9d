#pragma once

#include <array>
#include <optional>

#include "lodeline/mapping/keyframe/map_keyframe.h"
#include "lodeline/mapping/store/map_records.h"

namespace lodeline {

/// Pose of a square of known size by the rays to its corners. Least squares of the angles between rays and
/// corners over their sigmas.
struct TagPose {
  Rigid3 body_from_tag;    ///< tag frame: x right and y up on the print, z out of it, origin in its centre
  PositionPrior centre_B;  ///< with the covariance of the angles alone
  double rms_sigmas = 0.0;
};

/// `corners`: lower left, lower right, upper right, upper left. Nothing where no square in front of the
/// camera fits.
std::optional<TagPose> tagPose(const std::array<BodyRay, 4>& corners, double size_m);

}  // namespace lodeline
