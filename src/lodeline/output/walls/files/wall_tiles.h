#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lodeline/output/walls/fusion/wall_mesh.h"

namespace lodeline {

/// Surfaces of a dive in files, one for each tile, and their sums. Writers read one tile at a time, so that
/// memory does not grow with the dive.
struct WallTiles {
  std::vector<std::filesystem::path> files;
  size_t vertices = 0, triangles = 0;
  Eigen::AlignedBox3f box;

  /// Adds a tile that has triangles.
  void add(const std::filesystem::path& file, const WallMesh& mesh);
};

/// Little-endian values, one after the other.
template <typename Value>
void appendValue(std::string* bytes, const Value& value) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// Binary PLY, m: points with normal, colour and number of views (`observations`), and the triangles where
/// `with_triangles`. `notes`: one comment each. Throws InputError where the file cannot be written.
void writeWallsPly(const WallTiles& tiles, const std::vector<std::string>& notes, bool with_triangles,
                   const std::filesystem::path& file);

/// Binary glTF 2.0 with one primitive for each tile; y up, as glTF wants it. Throws InputError where the file
/// cannot be written or would be larger than the 4 GB that the format can hold.
void writeWallsGlb(const WallTiles& tiles, const std::vector<std::string>& notes,
                   const std::filesystem::path& file);

}  // namespace lodeline
