#pragma once

#include "lodeline/output/walls/fusion/tile_fusion.h"

namespace lodeline {

/// The part of a mesh in a tile, in an order that does not depend on threads: vertices by their coordinates,
/// equal ones joined, triangles by their vertices. Separate parts of fewer than `min_part_triangles`
/// triangles are left out where they do not reach beyond the tile. A triangle belongs to the tile of its
/// middle, so neighbouring tiles share none. Normals are those before the mesh is cut.
WallMesh canonicalMesh(const WallMesh& mesh, const Tile& tile, const FusionOptions& options);

}  // namespace lodeline
