#include <fmt/format.h>

#include "lodeline/output/walls/files/wall_tiles.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

std::string plyHeader(const WallTiles& tiles, const std::vector<std::string>& notes, bool with_triangles) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& note : notes) text += "comment " + note + "\n";
  text += fmt::format("element vertex {}\n", tiles.vertices);
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) text += fmt::format("property float {}\n", name);
  for (const char* name : {"red", "green", "blue"}) text += fmt::format("property uchar {}\n", name);
  text += "property int observations\n";
  if (with_triangles)
    text += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", tiles.triangles);
  return text + "end_header\n";
}

}  // namespace

void WallTiles::add(const std::filesystem::path& file, const WallMesh& mesh) {
  if (mesh.empty()) return;
  files.push_back(file);
  vertices += mesh.vertices();
  triangles += mesh.triangles.size();
  for (const WallMesh::Point& point : mesh.positions) box.extend(point);
}

void writeWallsPly(const WallTiles& tiles, const std::vector<std::string>& notes, bool with_triangles,
                   const std::filesystem::path& file) {
  std::ofstream stream = openOutput(file);
  stream << plyHeader(tiles, notes, with_triangles);
  for (const std::filesystem::path& tile : tiles.files) {
    const WallMesh mesh = readTileFile(tile);
    std::string bytes;
    for (size_t i = 0; i < mesh.vertices(); ++i) {
      bytes.append(reinterpret_cast<const char*>(mesh.positions[i].data()), 12);
      bytes.append(reinterpret_cast<const char*>(mesh.normals[i].data()), 12);
      appendValue(&bytes, mesh.colours[i]);
      appendValue(&bytes, static_cast<int32_t>(mesh.views[i]));
    }
    stream << bytes;
  }
  uint32_t first = 0;
  for (const std::filesystem::path& tile : with_triangles ? tiles.files : decltype(tiles.files)()) {
    const WallMesh mesh = readTileFile(tile);
    std::string bytes;
    for (const auto& triangle : mesh.triangles) {
      appendValue(&bytes, uint8_t{3});
      for (const uint32_t corner : triangle) appendValue(&bytes, first + corner);
    }
    stream << bytes;
    first += static_cast<uint32_t>(mesh.vertices());
  }
  closeOutput(file, &stream);
}

}  // namespace lodeline
