#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Triangles of the walls in the map (east, north, up; m).
struct WallMesh {
  using Point = Eigen::Vector3f;

  std::vector<Point> positions;
  std::vector<Point> normals;                   ///< unit, towards the water
  std::vector<std::array<uint8_t, 3>> colours;  ///< red, green, blue
  std::vector<uint16_t> views;                  ///< number of keyframes that saw the place
  std::vector<std::array<uint32_t, 3>> triangles;

  bool empty() const { return triangles.empty(); }
  size_t vertices() const { return positions.size(); }

  /// Normals as area-weighted means of the triangles about each vertex.
  void computeNormals();
  /// Removes vertices that no triangle uses; the others keep their order.
  void removeUnused();
};

/// Writes a mesh as one file, whole or not at all. Throws InputError naming the file.
void writeTileFile(const WallMesh& mesh, const std::filesystem::path& file);
/// Throws InputError where the file is missing or damaged.
WallMesh readTileFile(const std::filesystem::path& file);

}  // namespace lodeline
