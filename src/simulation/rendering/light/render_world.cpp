#include "simulation/rendering/light/render_world.h"

#include "simulation/rendering/cave/cave_furniture.h"
#include "simulation/rendering/cave/cave_walls.h"
#include "simulation/rendering/cave/tube_interior.h"

namespace lodeline {
namespace {

// Walls of two passages that agree to less than this are both kept, so that no hole opens between them. It is
// less than the clearance between walls and the diver's corridor.
constexpr float kJoint_m = 0.12f;

}  // namespace

TriangleMesh makeCaveMesh(const Centerline& centerline, const CaveOptions& options) {
  CaveWalls walls =
      makeCaveWalls(centerline, options.style, options.seed, options.clearance_m, options.max_triangles);
  walls.mesh.append(makeCaveFurniture(walls, options.style, options.seed, options.clearance_m));
  return std::move(walls.mesh);
}

TriangleMesh makeCaveMesh(const CaveLayout& cave, const CaveOptions& options) {
  if (cave.passages.size() == 1) return makeCaveMesh(cave.passages.front(), options);
  double length_m = 0.0;
  for (const Centerline& passage : cave.passages) length_m += passage.length_m();
  std::vector<CaveWalls> tubes;
  for (const Centerline& passage : cave.passages) {
    const auto triangles =
        static_cast<size_t>(static_cast<double>(options.max_triangles) * passage.length_m() / length_m);
    tubes.push_back(makeCaveWalls(passage, options.style, options.seed, options.clearance_m, triangles));
  }
  std::vector<TubeInterior> interiors;
  for (const CaveWalls& tube : tubes) interiors.emplace_back(tube);
  TriangleMesh mesh;
  for (size_t k = 0; k < tubes.size(); ++k) {
    // Objects stand on walls that are left, and not in the way through the other passage.
    const auto isFree = [&](const Vec3f& point, float radius_m) {
      for (size_t other = 0; other < tubes.size(); ++other) {
        if (other != k && interiors[other].contains(point, -radius_m)) return false;
      }
      return true;
    };
    TriangleMesh walls = tubes[k].mesh;
    for (size_t other = 0; other < tubes.size(); ++other) {
      if (other != k) removeInside(interiors[other], kJoint_m, &walls);
    }
    mesh.append(walls);
    mesh.append(makeCaveFurniture(tubes[k], options.style, options.seed + k, options.clearance_m, isFree));
  }
  return mesh;
}

std::shared_ptr<const RenderWorld> buildCaveWorld(const CaveLayout& cave_C, const CaveOptions& options,
                                                  const std::vector<LineTag>& tags_C,
                                                  const Vec3& cave_origin_W) {
  TriangleMesh mesh = makeTagMesh(tags_C);
  mesh.append(makeCaveMesh(cave_C, options));
  const Vec3f origin_W = cave_origin_W.cast<float>();
  for (Vec3f& position : mesh.positions) position += origin_W;
  const auto world = std::make_shared<RenderWorld>(std::move(mesh), options.seed);
  world->texture_origin_W = origin_W;
  for (const LineTag& tag : tags_C) world->panels.push_back(tagPanel(tag, cave_origin_W));
  return world;
}

std::shared_ptr<const RenderWorld> buildCaveWorld(const Centerline& centerline, const CaveOptions& options) {
  return std::make_shared<const RenderWorld>(makeCaveMesh(centerline, options), options.seed);
}

std::shared_ptr<const RenderWorld> buildWreckWorld(const WreckOptions& options) {
  return std::make_shared<const RenderWorld>(makeWreck(options), options.seed);
}

std::shared_ptr<const RenderWorld> buildBoardWorld(const CalibrationBoard& board,
                                                   const Rigid3& world_from_board, uint64_t seed) {
  const auto world = std::make_shared<RenderWorld>(makeBoardMesh(board, world_from_board), seed);
  world->panels.push_back(boardPanel(board, world_from_board));
  return world;
}

}  // namespace lodeline
