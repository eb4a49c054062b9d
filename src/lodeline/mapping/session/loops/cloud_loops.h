#pragma once

#include <functional>
#include <vector>

#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// Loops between the way in and the way out of a dive by the shape of the passage (mapping/cloud). Loads the
/// features of one stretch at a time, so that memory does not grow with the dive. `keyframes`: of one dive,
/// in order, without features; `features`: those of a keyframe. `view_B`: viewing direction in the body,
/// unit.
std::vector<Loop> cloudLoops(const std::vector<MapKeyframe>& keyframes,
                             const std::function<std::vector<MapFeature>(KeyframeId)>& features,
                             const Vec3& view_B);

}  // namespace lodeline
