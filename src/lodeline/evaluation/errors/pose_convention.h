#pragma once

#include <string>

#include "lodeline/diagnostics.h"
#include "lodeline/trajectory.h"

namespace lodeline {

/// Reports where positions disagree, and would agree far better under another convention of one trajectory:
/// "poses_inverted" for poses that map the world to the body, and "position_scale" for another or no unit of
/// length with an alignment without scale. Returns true where poses are inverted.
bool checkPoseConvention(const PosePairs& pairs, AlignmentType alignment, Diagnostics& diagnostics);

/// What the times of two trajectories without common times may be, in words, with the remedy: two time zones,
/// GPS time, a clock that counts from its start.
std::string differenceOfClocks(const Trajectory& estimate, const Trajectory& reference);

}  // namespace lodeline
