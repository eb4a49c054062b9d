#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulation/rendering/optics/render_types.h"

namespace lodeline {

/// Reflection properties of a surface at one vertex.
struct Material {
  uint8_t reflectance = 115;  ///< mean diffuse albedo * 255
  uint8_t contrast = 255;  ///< strength of the solid texture and its relief * 255; low on silt and flowstone
  uint8_t gloss = 0;       ///< strength of a broad highlight * 255 (wet flowstone)

  static Material of(float albedo, float contrast, float gloss = 0.0f);
};

/// A triangle mesh in world coordinates (m). The lit side is that of the normals.
struct TriangleMesh {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  ///< unit; see computeNormals
  std::vector<Material> materials;
  std::vector<std::array<uint32_t, 3>> triangles;  ///< counter-clockwise as seen from the lit side

  /// Adds a vertex without normal and returns its index.
  uint32_t addVertex(const Vec3f& position, const Material& material);

  /// Computes normals as area-weighted means of the adjacent triangles' normals.
  void computeNormals();

  void append(const TriangleMesh& other);
};

/// A grid of rows x columns vertices, row after row; `closed` joins the last column to the first. The lit
/// side is that of (step to the next column) x (step to the next row).
void addGridTriangles(TriangleMesh& mesh, uint32_t first_vertex, int rows, int columns, bool closed);

/// Triangles between two closed rows of as many vertices, as between neighbouring rows of a grid.
void joinRows(TriangleMesh& mesh, uint32_t first_row, uint32_t second_row, int columns);

/// Sphere of unit radius by recursive subdivision of an icosahedron: 20 * 4^subdivisions triangles.
TriangleMesh unitIcosphere(int subdivisions);

}  // namespace lodeline
