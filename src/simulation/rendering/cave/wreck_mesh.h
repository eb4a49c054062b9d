#pragma once

#include "simulation/rendering/cave/triangle_mesh.h"

namespace lodeline {

/// Size of a ship's hull, m.
struct HullShape {
  float half_length_m = 12.0f;
  float half_beam_m = 3.0f;
  float depth_m = 3.5f;
  float sunk_m = 0.7f;  ///< depth of the keel below the sand
  /// Share of the length that has broken off at bow and stern, so that a way leads through the hull.
  float open_share = 0.0f;

  /// Point of the hull at u along (stern 0, bow 1) and v around (starboard rail 0, keel 0.5, port rail 1).
  /// Axes: x to the bow, y to port, z up, origin on the sand below the middle of the ship.
  Vec3f point(float u, float v) const;
};

/// A ship on a sandy bottom. The mast top of the small one is 8 m above the bottom.
struct WreckOptions {
  uint64_t seed = 1;
  HullShape hull;
  float list_rad = 0.16f;          ///< the ship leans to one side
  Vec3f center_W = Vec3f::Zero();  ///< on the sea bottom, below the middle of the ship, m
  float heading_rad = 0.5f;        ///< direction of the bow, counter-clockwise from east
  float seabed_half_m = 35.0f;     ///< the bottom is a square of twice this width
};

/// Mesh of a hull with holes, deck, wheelhouse, mast, cargo boxes and nearby boulders on a rippled seabed.
/// Normals are included.
TriangleMesh makeWreck(const WreckOptions& options);

}  // namespace lodeline
