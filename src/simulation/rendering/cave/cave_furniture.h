#pragma once

#include <functional>

#include "simulation/rendering/cave/cave_walls.h"

namespace lodeline {

/// Mesh of breakdown blocks on the floor and, depending on the style, stalactites, stalagmites and columns.
/// All keep `clearance_m` from the diver's corridor. Normals are included. Where given, `isFree` tells
/// whether an object of a radius (m) at a point may stand there.
TriangleMesh makeCaveFurniture(const CaveWalls& walls, const CaveStyle& style, uint64_t seed,
                               double clearance_m,
                               const std::function<bool(const Vec3f&, float)>& isFree = {});

/// An angular block of about unit radius: a sphere cut by random planes, then roughened.
TriangleMesh makeBoulder(uint64_t seed, int subdivisions);

}  // namespace lodeline
