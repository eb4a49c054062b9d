#pragma once

#include <memory>
#include <vector>

#include "lodeline/batch/loops/loop_observation.h"
#include "lodeline/cameras/camera.h"
#include "lodeline/mapping/session/loops/known_keyframes.h"
#include "lodeline/mapping/session/loops/loop_acceptance.h"

namespace lodeline {

/// Accepted loops within one dive as the batch solution takes them: observations of old landmarks in new
/// images, and the poses of the keyframes that close the loops, in the odometry's world of the first one.
/// `cameras`: as the calibration files describe them, because the batch solution estimates corrections.
LoopClosures loopClosures(const std::vector<VerifiedLoop>& accepted, const KnownKeyframes& known, int dive,
                          const std::vector<std::shared_ptr<const Camera>>& cameras);

}  // namespace lodeline
