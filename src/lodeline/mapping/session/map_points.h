#pragma once

#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/mapping/store/map_file.h"

namespace lodeline {

/// Points of one dive in the frame of the map, by the common solution. A point that several keyframes know is
/// taken from the one that knows its distance best; `observations` counts these keyframes.
std::vector<MapLandmark> mapPointsOf(const MapFile& map, DiveId dive);

}  // namespace lodeline
