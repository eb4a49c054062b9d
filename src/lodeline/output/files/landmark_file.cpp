#include "lodeline/output/files/landmark_file.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

static_assert(std::endian::native == std::endian::little, "landmarks.ply is read as it lies in memory");

/// One vertex in the layout of the file.
struct Vertex {
  std::array<float, 3> position;
  int32_t observations;
};
static_assert(sizeof(Vertex) == 16);

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw InputError(
      fmt::format("{}: {}; landmarks.ply of `lodeline run` is wanted (run again, or remove the file to do "
                  "without landmarks)",
                  file.string(), what));
}

/// Reads the header and returns the number of vertices; empty where the file ends within its header.
std::optional<size_t> readHeader(std::ifstream& stream, const std::filesystem::path& file) {
  // Early versions had another name for the number of observations.
  const std::string kCount = "property int ";
  const std::string wanted = "property float x\nproperty float y\nproperty float z\n" + kCount + "\n";
  std::string line, properties;
  std::optional<size_t> count;
  bool is_binary = false;
  if (!std::getline(stream, line)) return std::nullopt;
  if (line != "ply") refuse(file, "no PLY file");
  while (std::getline(stream, line) && line != "end_header") {
    if (line == "format binary_little_endian 1.0") is_binary = true;
    if (line.starts_with("element vertex ")) count = std::strtoull(line.c_str() + 15, nullptr, 10);
    if (line.starts_with(kCount)) line = kCount;
    if (line.starts_with("property ")) properties += line + "\n";
  }
  if (!stream) return std::nullopt;
  if (!is_binary || !count || properties != wanted) refuse(file, "not the layout of a run's landmarks");
  return *count;
}

}  // namespace

std::vector<MapLandmark> readLandmarkFile(const std::filesystem::path& file, Diagnostics* diagnostics) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string() + ": cannot be opened");
  const std::optional<size_t> count = readHeader(stream, file);
  std::vector<MapLandmark> landmarks;
  size_t read = 0;
  std::array<char, sizeof(Vertex)> bytes;
  while (count && stream.read(bytes.data(), bytes.size())) {
    ++read;
    const Vertex vertex = std::bit_cast<Vertex>(bytes);
    const Vec3 position(vertex.position[0], vertex.position[1], vertex.position[2]);
    if (position.allFinite()) landmarks.push_back({position, vertex.observations});
  }
  if (!count || read != *count) {
    diagnostics->report(Severity::Warning, "landmarks_incomplete",
                        fmt::format("{}: the run that wrote it did not end; its first {} landmarks are used",
                                    file.string(), read));
  }
  return landmarks;
}

}  // namespace lodeline
