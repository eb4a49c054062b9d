#pragma once

#include "lodeline/trajectory.h"

namespace lodeline {

/// The poses of `odometry`, each moved rigidly with the nearest pose in time of `solved`: the motion between
/// both is that of the odometry. Both are of one body and one clock. Poses more than `longest_s` away from
/// any pose of `solved` are left out, and so are poses of `solved` at which `odometry` has none.
Trajectory carriedTrajectory(const Trajectory& odometry, const Trajectory& solved, double longest_s = 3.0);

}  // namespace lodeline
