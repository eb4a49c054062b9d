#pragma once

#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/recording.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {

/// Points at which the beam of a recording's sonar hit the walls, in the trajectory's world (m). The sonar
/// has the pose of its extrinsics, its head rotates about its z axis, and at angle 0 the beam points along x.
/// Echoes without a pose within 0.2 s on both sides are skipped; empty without a sonar. Reads the sonar's
/// stream to its end. `progress`: takes the place of each echo between the first pose and the
/// last, 0 to 1.
std::vector<Vec3> sonarWalls(
    MeasurementSource& source, const Trajectory& trajectory, Diagnostics* diagnostics,
    const ShareDone& progress = [](double) {});

}  // namespace lodeline
