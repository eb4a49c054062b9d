#pragma once

#include <vector>

#include "lodeline/estimator/initialization/relative_pose.h"
#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Rays of the tracks that camera 0 observes in both frames.
std::vector<BearingPair> commonTracks(const Window& window, const Frame& a, const Frame& b);

/// Estimates poses of all frames and landmarks of a single camera's window, up to scale, in axes of the
/// oldest camera: relative pose of the oldest and the newest frame, resection of the frames in between, then
/// bundle adjustment. The gyroscope's intervals (between consecutive frames, in order) give initial rotations
/// in between. Returns false if the images do not agree on a rigid structure.
bool estimateStructure(Window& window, const std::vector<Preintegration*>& intervals,
                       const FactorBuilder& factors, double focal_px,
                       const MonoInitializationOptions& options);

}  // namespace lodeline
