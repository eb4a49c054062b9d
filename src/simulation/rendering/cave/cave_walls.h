#pragma once

#include <cstdint>
#include <vector>

#include "simulation/rendering/cave/cave_style.h"
#include "simulation/rendering/cave/centerline.h"
#include "simulation/rendering/cave/triangle_mesh.h"

namespace lodeline {

/// One ring of wall vertices around the passage.
struct WallRing {
  Vec3f center = Vec3f::Zero();
  Vec3f forward = Vec3f::UnitX();  ///< unit
  Vec3f right = Vec3f::UnitY();    ///< unit, to the right across the passage
  Vec3f up = Vec3f::UnitZ();       ///< unit, right x forward
  float half_width_m = 0.0f;
  float half_height_m = 0.0f;
  float taper = 1.0f;  ///< below 1 where the passage narrows to its closed ends

  /// Whether a point near the ring's plane is at least `margin_m` outside the diver's corridor.
  bool clearOfCorridor(const Vec3f& point, float margin_m) const;
};

/// Walls, ceiling and sediment floor of a passage as a closed tube with its vertices in rings. In a circuit,
/// the first ring follows the last one.
struct CaveWalls {
  std::vector<WallRing> rings;
  bool closed = false;  ///< whether the passage is a circuit
  int ring_size =
      0;  ///< vertex j of ring i: index i * ring_size + j, at angle 2 pi j / ring_size from `right` to `up`
  TriangleMesh mesh;  ///< includes normals

  const Vec3f& vertex(int ring, int j) const {
    return mesh.positions[static_cast<size_t>(ring) * ring_size + j];
  }
};

/// Makes the walls by sweeping a superelliptic section along the centreline. Layered noise displaces it
/// (large alcoves, bedding ledges, crags down to the size of a triangle). Sediment fills its lower part, and
/// both ends of an open passage are closed. The relief is a function of the place. All walls keep
/// `clearance_m` from the diver's corridor. The mesh has at most about `max_triangles`.
CaveWalls makeCaveWalls(const Centerline& centerline, const CaveStyle& style, uint64_t seed,
                        double clearance_m, size_t max_triangles);

}  // namespace lodeline
