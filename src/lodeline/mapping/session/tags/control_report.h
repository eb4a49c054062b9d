#pragma once

#include <filesystem>

#include "lodeline/mapping/store/map_file.h"

namespace lodeline {

/// Writes `control.csv`: one row for each observation of a control point or tag of a map, with its residual
/// in the stored solution. Writes nothing where the map has no observation. Throws InputError where the file
/// cannot be written.
void writeControlReport(const std::filesystem::path& file, const MapFile& map);

}  // namespace lodeline
