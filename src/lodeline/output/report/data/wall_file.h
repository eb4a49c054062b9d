#pragma once

#include <filesystem>

#include "lodeline/output/report/data/cloud_json.h"

namespace lodeline {

/// Reads the points of the walls: vertices of a binary little-endian PLY file with x, y, z (m, world of the
/// run), and red, green, blue of 8 bits if present. Other properties of a vertex and other elements, such as
/// the faces of a mesh, are passed over. Throws InputError for any other layout, and where the file ends
/// before its last vertex.
ColouredPoints readWallFile(const std::filesystem::path& file);

}  // namespace lodeline
