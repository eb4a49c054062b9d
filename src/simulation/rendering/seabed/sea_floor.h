#pragma once

#include <cstdint>

#include "simulation/rendering/cave/triangle_mesh.h"

namespace lodeline {

/// A natural bottom: dunes of sand with ripples, outcrops of rock, boulders and stones. Its frame F has the
/// axes of W and any origin.
class SeaFloor {
 public:
  explicit SeaFloor(uint64_t seed) : seed_(static_cast<uint32_t>(seed) + 300u) {}

  /// Height of the ground without stones, m; within 1.5 m of 0.
  float height_m(float east_m, float north_m) const;
  Material materialAt(float east_m, float north_m) const;

 private:
  /// 0 on sand, 1 on rock.
  float rockShare(float east_m, float north_m) const;

  uint32_t seed_;
};

struct SeaFloorOptions {
  uint64_t seed = 1;
  Vec3f origin_W = Vec3f::Zero();             ///< of F, m
  Vec3f low_F = Vec3f(-20.0f, -20.0f, 0.0f);  ///< corners of the rectangle in F, m
  Vec3f high_F = Vec3f(20.0f, 20.0f, 0.0f);
  float cell_m = 0.07f;
};

/// Mesh of the floor with stones, in W. Normals are included.
TriangleMesh makeSeaFloor(const SeaFloorOptions& options);

}  // namespace lodeline
