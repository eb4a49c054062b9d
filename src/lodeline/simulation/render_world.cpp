#include "lodeline/simulation/render_world.h"

#include "lodeline/simulation/cave_furniture.h"
#include "lodeline/simulation/cave_walls.h"

namespace lodeline {

std::shared_ptr<const RenderWorld> buildCaveWorld(const Centerline& centerline, const CaveOptions& options) {
  CaveWalls walls =
      makeCaveWalls(centerline, options.style, options.seed, options.clearance_m, options.max_triangles);
  const TriangleMesh furniture = makeCaveFurniture(walls, options.style, options.seed, options.clearance_m);
  walls.mesh.append(furniture);
  return std::make_shared<const RenderWorld>(std::move(walls.mesh), options.seed);
}

std::shared_ptr<const RenderWorld> buildWreckWorld(const WreckOptions& options) {
  return std::make_shared<const RenderWorld>(makeWreck(options), options.seed);
}

}  // namespace lodeline
