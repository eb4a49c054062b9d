#pragma once

#include "simulation/rendering/cave/cave_walls.h"

namespace lodeline {

/// Breakdown blocks on the floor and, where the style has them, stalactites, stalagmites and columns. None
/// comes within `clearance_m` of the diver's corridor. Normals included.
TriangleMesh makeCaveFurniture(const CaveWalls& walls, const CaveStyle& style, uint64_t seed,
                               double clearance_m);

/// An angular block of about unit radius: a sphere cut by random planes, then roughened.
TriangleMesh makeBoulder(uint64_t seed, int subdivisions);

}  // namespace lodeline
