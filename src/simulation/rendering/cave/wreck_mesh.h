#pragma once

#include "simulation/rendering/cave/triangle_mesh.h"

namespace lodeline {

/// A small ship on a sandy bottom. Its hull measures 24 x 6 x 3.5 m; the mast top is 8 m above the bottom.
struct WreckOptions {
  uint64_t seed = 1;
  Vec3f center_W = Vec3f::Zero();  ///< on the sea bottom, below the middle of the ship, m
  float heading_rad = 0.5f;        ///< direction of the bow, counter-clockwise from east
  float seabed_half_m = 35.0f;     ///< the bottom is a square of twice this width
};

/// Mesh of a hull with holes, deck, wheelhouse, mast, cargo boxes and nearby boulders on a rippled seabed.
/// Normals are included.
TriangleMesh makeWreck(const WreckOptions& options);

}  // namespace lodeline
