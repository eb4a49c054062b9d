#include "lodeline/output/report/data/wall_file.h"

#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

/// Where the properties of a vertex are in its bytes.
struct Layout {
  struct Property {
    size_t offset = 0;
    std::string type;
  };
  size_t vertices = 0;
  size_t bytes = 0;  ///< of a vertex
  std::map<std::string, Property> properties;
};

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw InputError(
      fmt::format("{}: {}; a binary little-endian PLY file with x, y, z is wanted (remove the "
                  "file to do without walls)",
                  file.string(), what));
}

std::optional<size_t> bytesOf(const std::string& type) {
  static const std::map<std::string, size_t> sizes = {
      {"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},  {"short", 2}, {"ushort", 2},
      {"int16", 2}, {"uint16", 2},  {"int", 4},    {"uint", 4},   {"int32", 4}, {"uint32", 4},
      {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  const auto found = sizes.find(type);
  return found == sizes.end() ? std::nullopt : std::optional<size_t>(found->second);
}

bool isFloat(const std::string& type) { return type == "float" || type == "float32"; }
bool isDouble(const std::string& type) { return type == "double" || type == "float64"; }
bool isByte(const std::string& type) { return type == "uchar" || type == "uint8"; }

/// Vertices have to be the first element: what is before them may have any length.
Layout readHeader(std::ifstream& stream, const std::filesystem::path& file) {
  Layout layout;
  std::string line, element;
  bool is_binary = false;
  if (!std::getline(stream, line) || line.rfind("ply", 0) != 0) refuse(file, "no PLY file");
  while (std::getline(stream, line)) {
    std::istringstream words(line);
    std::string word, type, name;
    words >> word;
    if (word == "end_header") break;
    if (word == "format") is_binary = words >> type && type == "binary_little_endian";
    if (word == "element") {
      const bool is_first = element.empty();
      words >> element;
      if (is_first && (element != "vertex" || !(words >> layout.vertices)))
        refuse(file, "the first element is not 'vertex'");
    }
    if (word != "property" || element != "vertex") continue;
    words >> type >> name;
    const std::optional<size_t> bytes = bytesOf(type);
    if (!bytes) refuse(file, fmt::format("a vertex has the property '{}'", line));
    layout.properties[name] = {layout.bytes, type};
    layout.bytes += *bytes;
  }
  if (!stream) refuse(file, "the header has no end");
  if (!is_binary) refuse(file, "not in binary little-endian format");
  for (const char* axis : {"x", "y", "z"}) {
    const auto found = layout.properties.find(axis);
    if (found == layout.properties.end() || !(isFloat(found->second.type) || isDouble(found->second.type)))
      refuse(file, fmt::format("vertices have no '{}' of type float or double", axis));
  }
  return layout;
}

float coordinate(const char* vertex, const Layout::Property& property) {
  if (isFloat(property.type)) {
    float value;
    std::memcpy(&value, vertex + property.offset, sizeof(value));
    return value;
  }
  double value;
  std::memcpy(&value, vertex + property.offset, sizeof(value));
  return static_cast<float>(value);
}

bool hasColours(const Layout& layout) {
  for (const char* name : {"red", "green", "blue"}) {
    const auto found = layout.properties.find(name);
    if (found == layout.properties.end() || !isByte(found->second.type)) return false;
  }
  return true;
}

}  // namespace

ColouredPoints readWallFile(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(file.string() + ": cannot be opened");
  const Layout layout = readHeader(stream, file);
  const auto at = [&](const char* name) { return layout.properties.at(name); };
  const Layout::Property x = at("x"), y = at("y"), z = at("z");
  const bool has_colours = hasColours(layout);
  ColouredPoints points;
  std::vector<char> vertex(layout.bytes);
  for (size_t i = 0; i < layout.vertices; ++i) {
    if (!stream.read(vertex.data(), static_cast<std::streamsize>(vertex.size())))
      refuse(file, fmt::format("ends after {} of {} vertices", i, layout.vertices));
    const Eigen::Vector3f p(coordinate(vertex.data(), x), coordinate(vertex.data(), y),
                            coordinate(vertex.data(), z));
    if (!p.allFinite()) continue;
    points.positions.push_back(p);
    if (!has_colours) continue;
    const auto byte = [&](const char* name) { return static_cast<uint8_t>(vertex[at(name).offset]); };
    points.colours.push_back({byte("red"), byte("green"), byte("blue")});
  }
  return points;
}

}  // namespace lodeline
