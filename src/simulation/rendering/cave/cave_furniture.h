#pragma once

#include "simulation/rendering/cave/cave_walls.h"

namespace lodeline {

/// Mesh of breakdown blocks on the floor and, depending on the style, stalactites, stalagmites and columns.
/// All keep `clearance_m` from the diver's corridor. Normals are included.
TriangleMesh makeCaveFurniture(const CaveWalls& walls, const CaveStyle& style, uint64_t seed,
                               double clearance_m);

/// An angular block of about unit radius: a sphere cut by random planes, then roughened.
TriangleMesh makeBoulder(uint64_t seed, int subdivisions);

}  // namespace lodeline
