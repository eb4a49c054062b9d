#include "simulation/rendering/cave/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace lodeline {
namespace {

uint8_t toByte(float value) {
  return static_cast<uint8_t>(std::lround(255.0f * std::clamp(value, 0.0f, 1.0f)));
}

}  // namespace

Material Material::of(float albedo, float contrast, float gloss) {
  return {toByte(albedo), toByte(contrast), toByte(gloss)};
}

uint32_t TriangleMesh::addVertex(const Vec3f& position, const Material& material) {
  positions.push_back(position);
  materials.push_back(material);
  return static_cast<uint32_t>(positions.size() - 1);
}

void TriangleMesh::computeNormals() {
  normals.assign(positions.size(), Vec3f::Zero());
  for (const auto& t : triangles) {
    // The length of the cross product is twice the area, which gives the weight.
    const Vec3f normal = (positions[t[1]] - positions[t[0]]).cross(positions[t[2]] - positions[t[0]]);
    for (const uint32_t vertex : t) normals[vertex] += normal;
  }
  for (Vec3f& normal : normals) {
    const float length = normal.norm();
    normal = length > 0.0f ? Vec3f(normal / length) : Vec3f::UnitZ();
  }
}

void TriangleMesh::append(const TriangleMesh& other) {
  const uint32_t offset = static_cast<uint32_t>(positions.size());
  positions.insert(positions.end(), other.positions.begin(), other.positions.end());
  normals.insert(normals.end(), other.normals.begin(), other.normals.end());
  materials.insert(materials.end(), other.materials.begin(), other.materials.end());
  triangles.reserve(triangles.size() + other.triangles.size());
  for (const auto& t : other.triangles) {
    triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
}

void addGridTriangles(TriangleMesh& mesh, uint32_t first_vertex, int rows, int columns, bool closed) {
  const int spans = closed ? columns : columns - 1;
  for (int i = 0; i + 1 < rows; ++i) {
    for (int j = 0; j < spans; ++j) {
      const int next = (j + 1) % columns;
      const uint32_t a = first_vertex + static_cast<uint32_t>(i * columns + j);
      const uint32_t b = first_vertex + static_cast<uint32_t>(i * columns + next);
      const uint32_t c = first_vertex + static_cast<uint32_t>((i + 1) * columns + j);
      const uint32_t d = first_vertex + static_cast<uint32_t>((i + 1) * columns + next);
      // Alternating diagonals avoid a visible pattern in one direction.
      if ((i + j) % 2 == 0) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({b, d, c});
      } else {
        mesh.triangles.push_back({a, d, c});
        mesh.triangles.push_back({a, b, d});
      }
    }
  }
}

void joinRows(TriangleMesh& mesh, uint32_t first_row, uint32_t second_row, int columns) {
  for (int j = 0; j < columns; ++j) {
    const auto here = static_cast<uint32_t>(j), next = static_cast<uint32_t>((j + 1) % columns);
    mesh.triangles.push_back({first_row + here, first_row + next, second_row + here});
    mesh.triangles.push_back({first_row + next, second_row + next, second_row + here});
  }
}

TriangleMesh unitIcosphere(int subdivisions) {
  TriangleMesh mesh;
  const float t = 0.5f * (1.0f + std::sqrt(5.0f));
  const float corners[12][3] = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                                {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  for (const auto& c : corners) mesh.addVertex(Vec3f(c[0], c[1], c[2]).normalized(), {});
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> midpoints;
    const auto midpoint = [&](uint32_t a, uint32_t b) {
      const auto key = std::minmax(a, b);
      const auto found = midpoints.find(key);
      if (found != midpoints.end()) return found->second;
      const Vec3f middle = (mesh.positions[a] + mesh.positions[b]).normalized();
      return midpoints[key] = mesh.addVertex(middle, {});
    };
    std::vector<std::array<uint32_t, 3>> finer;
    finer.reserve(4 * mesh.triangles.size());
    for (const auto& f : mesh.triangles) {
      const uint32_t ab = midpoint(f[0], f[1]), bc = midpoint(f[1], f[2]), ca = midpoint(f[2], f[0]);
      finer.insert(finer.end(), {{f[0], ab, ca}, {f[1], bc, ab}, {f[2], ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

}  // namespace lodeline
