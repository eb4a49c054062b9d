#include "lodeline/output/walls/fusion/wall_mesh.h"

#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <string>

#include "lodeline/diagnostics.h"
#include "lodeline/output/walls/depth/depth_store.h"

namespace lodeline {
namespace {

template <typename Item>
void appendAll(const std::vector<Item>& items, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(Item));
}

template <typename Item>
bool readAll(std::ifstream* stream, size_t count, std::vector<Item>* items) {
  items->resize(count);
  stream->read(reinterpret_cast<char*>(items->data()), static_cast<std::streamsize>(count * sizeof(Item)));
  return static_cast<bool>(*stream);
}

}  // namespace

void WallMesh::computeNormals() {
  normals.assign(positions.size(), Point::Zero());
  for (const auto& [a, b, c] : triangles) {
    const Point normal = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
    for (const uint32_t corner : {a, b, c}) normals[corner] += normal;
  }
  for (Point& normal : normals) normal = normal.norm() > 0.0F ? normal.normalized() : Point::UnitZ();
}

void WallMesh::removeUnused() {
  std::vector<uint32_t> place(positions.size(), 0);
  for (const auto& triangle : triangles) {
    for (const uint32_t corner : triangle) place[corner] = 1;
  }
  uint32_t count = 0;
  for (size_t i = 0; i < place.size(); ++i) {
    if (place[i] == 0) continue;
    positions[count] = positions[i];
    normals[count] = normals[i];
    colours[count] = colours[i];
    views[count] = views[i];
    place[i] = count++;
  }
  positions.resize(count);
  normals.resize(count);
  colours.resize(count);
  views.resize(count);
  for (auto& triangle : triangles) {
    for (uint32_t& corner : triangle) corner = place[corner];
  }
}

void writeTileFile(const WallMesh& mesh, const std::filesystem::path& file) {
  const std::array<uint64_t, 2> counts = {mesh.vertices(), mesh.triangles.size()};
  std::string bytes(reinterpret_cast<const char*>(counts.data()), sizeof(counts));
  appendAll(mesh.positions, &bytes);
  appendAll(mesh.normals, &bytes);
  appendAll(mesh.colours, &bytes);
  appendAll(mesh.views, &bytes);
  appendAll(mesh.triangles, &bytes);
  writeWhole(file, bytes);
}

WallMesh readTileFile(const std::filesystem::path& file) {
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  std::array<uint64_t, 2> counts{};
  stream.read(reinterpret_cast<char*>(counts.data()), sizeof(counts));
  WallMesh mesh;
  const bool is_good =
      stream && !error && counts[0] <= size && counts[1] <= size &&
      readAll(&stream, counts[0], &mesh.positions) && readAll(&stream, counts[0], &mesh.normals) &&
      readAll(&stream, counts[0], &mesh.colours) && readAll(&stream, counts[0], &mesh.views) &&
      readAll(&stream, counts[1], &mesh.triangles);
  if (!is_good) throw InputError(fmt::format("{}: damaged; delete it and start again", file.string()));
  return mesh;
}

}  // namespace lodeline
