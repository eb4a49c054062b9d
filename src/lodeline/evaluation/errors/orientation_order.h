#pragma once

#include "lodeline/evaluation/errors/association.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Reports ("quaternion_order") where the orientations of both trajectories disagree and would agree far
/// better if the quaternions of one were read in another order: w first in place of last, last in place of
/// first, or inverse. Any constant rotation of the body is allowed, so that a body frame of another
/// convention is no finding; the rotation between the worlds is the positions' where they fix it, else any.
void checkOrientationOrder(const PosePairs& pairs, Diagnostics& diagnostics);

}  // namespace lodeline
