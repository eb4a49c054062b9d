#pragma once

#include "lodeline/diagnostics.h"
#include "lodeline/trajectory.h"

namespace lodeline {

/// Reports ("quaternion_order") where the orientations of both trajectories disagree and would agree far
/// better with another quaternion order in one of them: w first in place of last, last in place of first, or
/// inverse. Any constant rotation of the body is allowed, so that another convention of the body frame is not
/// a finding. The rotation between the worlds is that of the positions where they determine it, else any.
void checkOrientationOrder(const PosePairs& pairs, Diagnostics& diagnostics);

}  // namespace lodeline
