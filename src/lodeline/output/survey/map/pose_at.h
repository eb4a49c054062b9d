#pragma once

#include <optional>

#include "lodeline/trajectory.h"

namespace lodeline {

/// The pose at a time between two poses: position linear, rotation by slerp. Empty without a pose within
/// 0.2 s on both sides.
std::optional<Rigid3> poseAt(const Trajectory& trajectory, Time time);

}  // namespace lodeline
