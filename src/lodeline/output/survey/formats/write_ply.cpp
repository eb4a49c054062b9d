#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "lodeline/output/survey/formats/point_normals.h"
#include "lodeline/output/survey/formats/write_formats.h"

namespace lodeline {
namespace {

using Colour = std::array<uint8_t, 3>;

template <typename Value>
void append(std::string* bytes, const Value& value) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void appendVertex(std::string* bytes, const Vec3& position, const Vec3& normal, const Colour& colour,
                  int observations) {
  for (const Vec3& vector : {position, normal}) {
    for (int axis = 0; axis < 3; ++axis) append(bytes, static_cast<float>(vector[axis]));
  }
  append(bytes, colour);
  append(bytes, static_cast<int32_t>(observations));
}

/// Colour of a depth: shallow is yellow, deep is blue.
Colour colourOf(double share) {
  const double s = std::clamp(share, 0.0, 1.0);
  const auto mix = [s](double shallow, double deep) {
    return static_cast<uint8_t>(std::lround(shallow + s * (deep - shallow)));
  };
  return {mix(255.0, 30.0), mix(210.0, 80.0), mix(30.0, 255.0)};
}

constexpr Colour kWallColour = {170, 160, 145};

std::string header(const DiveMap& map, size_t vertices, size_t edges) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  for (const std::string& note : map.notes) text += "comment " + note + "\n";
  text += fmt::format("comment metres {} from the first pose; first the {} poses, then landmarks\n",
                      map.north.axes, map.trajectory.size());
  text += fmt::format("element vertex {}\n", vertices);
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) text += fmt::format("property float {}\n", name);
  for (const char* name : {"red", "green", "blue"}) text += fmt::format("property uchar {}\n", name);
  text += fmt::format(
      "property int observations\nelement edge {}\nproperty int vertex1\nproperty int vertex2\n", edges);
  return text + "end_header\n";
}

}  // namespace

std::string plyBytes(const DiveMap& map) {
  std::vector<Vec3> way, walls;
  for (const StampedPose& pose : map.trajectory.poses) way.push_back(pose.world_from_body.translation);
  for (const MapLandmark& landmark : map.landmarks) walls.push_back(landmark.position);
  const auto [lowest, highest] =
      std::minmax_element(way.begin(), way.end(), [](const Vec3& a, const Vec3& b) { return a.z() < b.z(); });
  const double range_m = std::max(highest->z() - lowest->z(), 1e-3);

  std::string bytes = header(map, way.size() + walls.size(), way.size() - 1);
  for (const Vec3& position : way) {
    appendVertex(&bytes, position, Vec3::UnitZ(), colourOf((highest->z() - position.z()) / range_m), 0);
  }
  const std::vector<Vec3> normals = normalsTowards(walls, way);
  for (size_t i = 0; i < walls.size(); ++i) {
    appendVertex(&bytes, walls[i], normals[i], kWallColour, map.landmarks[i].observations);
  }
  for (size_t i = 1; i < way.size(); ++i) {
    append(&bytes, static_cast<int32_t>(i - 1));
    append(&bytes, static_cast<int32_t>(i));
  }
  return bytes;
}

}  // namespace lodeline
