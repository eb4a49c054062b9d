#pragma once

#include "lodeline/types.h"

namespace lodeline {

/// Where the new keyframe should be by odometry and earlier loops.
struct LoopPrediction {
  Rigid3 old_from_new;
  /// Of [dp, dtheta] in axes of the old body, as Loop::covariance.
  Mat6 covariance = Mat6::Identity();
};

}  // namespace lodeline
