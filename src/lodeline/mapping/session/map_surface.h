#pragma once

#include <optional>

#include "lodeline/mapping/graph/graph_elements.h"
#include "lodeline/mapping/store/map_file.h"

namespace lodeline {

/// Height of the surface of the water in the frame of a solved map, by the keyframe that knows its depth
/// best; empty where none knows it. The sigma is that of its depth.
std::optional<SurfaceHeight> surfaceOf(const MapFile& map);

}  // namespace lodeline
