#pragma once

#include <filesystem>

#include "lodeline/output/survey/map/dive_map.h"
#include "lodeline/output/walls/files/wall_tiles.h"

namespace lodeline {

/// The points as LAS 1.4 with point format 7 (colour), to a millimetre. Coordinates are those of
/// drawingPoint(): on the grid of the map, whose description is in the file, or metres from the first pose.
/// `user data` is the number of keyframes that saw the point, at most 255. Throws InputError where the file
/// cannot be written.
void writeLas(const WallTiles& tiles, const DiveMap& map, const std::filesystem::path& file);

}  // namespace lodeline
