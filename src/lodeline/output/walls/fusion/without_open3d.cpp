#include "lodeline/diagnostics.h"
#include "lodeline/output/walls/fusion/tile_fusion.h"

// In place of fusion/tile_fusion.cpp in a library without Open3D.

namespace lodeline {

bool hasOpen3d() { return false; }

std::optional<WallMesh> fuseTile(const Tile&, const DepthKeyframes&, const FusionOptions&) {
  throw UsageError("this program was built without Open3D, which fuses depths to walls");
}

}  // namespace lodeline
