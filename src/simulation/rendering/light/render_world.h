#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "simulation/rendering/board/board_panel.h"
#include "simulation/rendering/board/line_tag.h"
#include "simulation/rendering/cave/cave_layout.h"
#include "simulation/rendering/cave/cave_style.h"
#include "simulation/rendering/cave/solid_texture.h"
#include "simulation/rendering/cave/traced_scene.h"
#include "simulation/rendering/cave/wreck_mesh.h"

namespace lodeline {

/// Maximum distance at which the light of a lamp is visible, m.
inline constexpr float kSight_m = 60.0f;

/// The world of a dive for sonar and cameras: geometry and texture. World frame W, m.
struct RenderWorld {
  RenderWorld(TriangleMesh mesh, uint64_t seed) : scene(std::move(mesh)), texture(seed) {}

  TracedScene scene;
  SolidTexture texture;
  Vec3f texture_origin_W = Vec3f::Zero();
  std::vector<PrintedPanel> panels;  ///< on the first triangles of the scene
};

struct CaveOptions {
  CaveStyle style;
  uint64_t seed = 1;
  /// Minimum distance of walls, silt, boulders and stalactites from the diver's corridor, as room for lamps
  /// and arms.
  double clearance_m = 0.4;
  size_t max_triangles = 2'500'000;  ///< of the walls; boulders and stalactites are additional
};

/// Walls and furniture of a cave along a centreline, with normals.
TriangleMesh makeCaveMesh(const Centerline& centerline, const CaveOptions& options);

/// Walls and furniture of all passages of a cave. Where two passages overlap, the walls of each inside the
/// other are left out.
TriangleMesh makeCaveMesh(const CaveLayout& cave, const CaveOptions& options);

/// A cave of a layout in its frame C with tags on its line. In the dive's world, C has its origin at
/// `cave_origin_W`. Rock and texture depend on the cave and the options alone.
std::shared_ptr<const RenderWorld> buildCaveWorld(const CaveLayout& cave_C, const CaveOptions& options,
                                                  const std::vector<LineTag>& tags_C,
                                                  const Vec3& cave_origin_W);

/// A cave along a centreline.
std::shared_ptr<const RenderWorld> buildCaveWorld(const Centerline& centerline, const CaveOptions& options);

/// A wreck on the sea bottom in open water.
std::shared_ptr<const RenderWorld> buildWreckWorld(const WreckOptions& options);

/// A calibration board before a wall.
std::shared_ptr<const RenderWorld> buildBoardWorld(const CalibrationBoard& board,
                                                   const Rigid3& world_from_board, uint64_t seed);

}  // namespace lodeline
