#pragma once

#include <vector>

#include "lodeline/evaluation/trajectory/trajectory.h"
#include "lodeline/io/synchronizer/measurement_source.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Points where the beam of a recording's sonar met the walls, in the trajectory's world (m): the sonar lies
/// at its extrinsics, its head turns about its z axis, and at angle 0 the beam points along x. Echoes with no
/// pose within 0.2 s on both sides are left out; none without a sonar. Reads the sonar's stream to its end.
std::vector<Vec3> sonarWalls(MeasurementSource& source, const Trajectory& trajectory,
                             Diagnostics* diagnostics);

}  // namespace lodeline
