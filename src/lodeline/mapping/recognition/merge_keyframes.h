#pragma once

#include <span>

#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// One keyframe with the features of all keyframes of a clip, in the body frame of keyframe `reference` of
/// the clip. Id, time, pose and the other values are those of that keyframe.
///
/// Odometry carries rays and points over; rays keep their origins, so that the clip is one generalized
/// camera. The pose's drift within the clip adds to the distances' sigmas and to those of the rays. A point
/// that several keyframes observe occurs more than once only where its descriptors differ. `clip`: of one
/// dive, by rising time, a few seconds long. Throws UsageError where it is empty or mixed.
MapKeyframe mergeKeyframes(std::span<const MapKeyframe> clip, size_t reference);
/// In the body frame of the last keyframe.
MapKeyframe mergeKeyframes(std::span<const MapKeyframe> clip);

}  // namespace lodeline
