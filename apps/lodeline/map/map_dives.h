#pragma once

#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/control/files/control_set.h"
#include "lodeline/mapping/store/map_file.h"
#include "lodeline/survey.h"

namespace lodeline {

/// The dives of a map as runs whose world is the map: poses and covariances of the common solution. Throws
/// InputError where the map has no dive, or one without solved poses.
std::vector<RunFolder> runsOfMap(const MapFile& map);

/// Reads control points from a file, finds the dives of their visits, and adds both to the map in one change.
ControlSet addControlFile(MapFile* map, const std::filesystem::path& file, const ControlReadOptions& options,
                          Diagnostics* diagnostics);

}  // namespace lodeline
