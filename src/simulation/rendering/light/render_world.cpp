#include "simulation/rendering/light/render_world.h"

#include "simulation/rendering/cave/cave_furniture.h"
#include "simulation/rendering/cave/cave_walls.h"

namespace lodeline {

TriangleMesh makeCaveMesh(const Centerline& centerline, const CaveOptions& options) {
  CaveWalls walls =
      makeCaveWalls(centerline, options.style, options.seed, options.clearance_m, options.max_triangles);
  walls.mesh.append(makeCaveFurniture(walls, options.style, options.seed, options.clearance_m));
  return std::move(walls.mesh);
}

std::shared_ptr<const RenderWorld> buildCaveWorld(const Centerline& centerline, const CaveOptions& options) {
  return std::make_shared<const RenderWorld>(makeCaveMesh(centerline, options), options.seed);
}

std::shared_ptr<const RenderWorld> buildWreckWorld(const WreckOptions& options) {
  return std::make_shared<const RenderWorld>(makeWreck(options), options.seed);
}

std::shared_ptr<const RenderWorld> buildBoardWorld(const CalibrationBoard& board,
                                                   const Rigid3& world_from_board, uint64_t seed) {
  const BoardPanel panel(board, world_from_board);
  const auto world = std::make_shared<RenderWorld>(makeBoardMesh(panel), seed);
  world->board = panel;
  return world;
}

}  // namespace lodeline
