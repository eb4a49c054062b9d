#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "lodeline/output/walls/files/wall_tiles.h"
#include "lodeline/util/files/output_file.h"

// Format: Khronos Group, "glTF 2.0 Specification", sections 3.6, 3.7 and 4.4.

namespace lodeline {
namespace {

enum ComponentType { kByte = 5121, kInteger = 5125, kFloat = 5126 };
enum BufferTarget { kVertices = 34962, kIndices = 34963 };

/// The JSON chunk, tile by tile.
class Document {
 public:
  explicit Document(const std::vector<std::string>& notes) {
    json_["asset"] = {{"version", "2.0"}, {"generator", "lodeline walls"}, {"extras", {{"notes", notes}}}};
    json_["scene"] = 0;
    json_["scenes"] = {{{"nodes", {0}}}};
    // East, north, up to glTF's x, y up, z: by -90 degrees about x.
    json_["nodes"] = {{{"mesh", 0}, {"name", "walls"}, {"rotation", {-0.70710678, 0.0, 0.0, 0.70710678}}}};
    json_["materials"] = {{{"doubleSided", true},
                           {"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 1.0}}}}};
    json_["meshes"] = {{{"primitives", nlohmann::json::array()}}};
  }

  void add(const WallMesh& mesh) {
    const size_t count = mesh.vertices();
    Eigen::AlignedBox3f box;
    for (const WallMesh::Point& point : mesh.positions) box.extend(point);
    nlohmann::json positions = accessor(12 * count, kVertices, kFloat, count, "VEC3");
    positions["min"] = {box.min().x(), box.min().y(), box.min().z()};
    positions["max"] = {box.max().x(), box.max().y(), box.max().z()};
    nlohmann::json primitive;
    primitive["material"] = 0;
    primitive["attributes"]["POSITION"] = push(positions);
    primitive["attributes"]["NORMAL"] = push(accessor(12 * count, kVertices, kFloat, count, "VEC3"));
    nlohmann::json colours = accessor(4 * count, kVertices, kByte, count, "VEC4");
    colours["normalized"] = true;
    primitive["attributes"]["COLOR_0"] = push(colours);
    const size_t corners = 3 * mesh.triangles.size();
    primitive["indices"] = push(accessor(4 * corners, kIndices, kInteger, corners, "SCALAR"));
    json_["meshes"][0]["primitives"].push_back(primitive);
  }

  uint64_t binaryBytes() const { return bytes_; }
  std::string text() {
    json_["buffers"] = {{{"byteLength", bytes_}}};
    std::string text = json_.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    return text;
  }

 private:
  nlohmann::json accessor(size_t bytes, BufferTarget target, ComponentType type, size_t count,
                          const char* shape) {
    json_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", bytes_}, {"byteLength", bytes}, {"target", target}});
    bytes_ += bytes;
    return {{"bufferView", json_["bufferViews"].size() - 1},
            {"componentType", type},
            {"count", count},
            {"type", shape}};
  }
  size_t push(const nlohmann::json& accessor) {
    json_["accessors"].push_back(accessor);
    return json_["accessors"].size() - 1;
  }

  nlohmann::json json_;
  uint64_t bytes_ = 0;
};

std::string binaryOf(const WallMesh& mesh) {
  std::string bytes;
  for (const WallMesh::Point& point : mesh.positions)
    bytes.append(reinterpret_cast<const char*>(point.data()), 12);
  for (const WallMesh::Point& normal : mesh.normals)
    bytes.append(reinterpret_cast<const char*>(normal.data()), 12);
  for (const auto& [red, green, blue] : mesh.colours)
    appendValue(&bytes, std::array<uint8_t, 4>{red, green, blue, 255});
  bytes.append(reinterpret_cast<const char*>(mesh.triangles.data()), 12 * mesh.triangles.size());
  return bytes;
}

}  // namespace

void writeWallsGlb(const WallTiles& tiles, const std::vector<std::string>& notes,
                   const std::filesystem::path& file) {
  Document document(notes);
  for (const std::filesystem::path& tile : tiles.files) document.add(readTileFile(tile));
  const std::string json = document.text();
  const uint64_t total = 12 + 8 + json.size() + 8 + document.binaryBytes();
  if (total > std::numeric_limits<uint32_t>::max()) {
    throw InputError(
        fmt::format("{}: the mesh needs {:.1f} GB, and glTF holds 4 GB; take larger voxels (--voxel)",
                    file.string(), 1e-9 * static_cast<double>(total)));
  }
  std::string header = "glTF";
  for (const uint64_t value : {uint64_t{2}, total, uint64_t{json.size()}})
    appendValue(&header, static_cast<uint32_t>(value));
  std::ofstream stream = openOutput(file);
  stream << header << "JSON" << json;
  std::string chunk;
  appendValue(&chunk, static_cast<uint32_t>(document.binaryBytes()));
  stream << chunk << std::string("BIN\0", 4);
  for (const std::filesystem::path& tile : tiles.files) stream << binaryOf(readTileFile(tile));
  closeOutput(file, &stream);
}

}  // namespace lodeline
