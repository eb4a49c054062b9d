#include "lodeline/output/walls/fusion/tile_fusion.h"

#include "lodeline/diagnostics.h"
#include "lodeline/output/walls/fusion/canonical_mesh.h"
#include "lodeline/output/walls/fusion/surface_blocks.h"
#include "lodeline/output/walls/fusion/wall_volume.h"

namespace lodeline {

bool hasOpen3d() {
  try {
    wallVolumeModule();
    return true;
  } catch (const UsageError&) {
    return false;
  }
}

std::optional<WallMesh> fuseTile(const Tile& tile, const DepthKeyframes& input,
                                 const FusionOptions& options) {
  const auto blocks = surfaceBlocks(tile, input, options);
  if (!blocks) return std::nullopt;
  if (blocks->empty()) return WallMesh();
  const std::unique_ptr<WallVolume> volume(wallVolumeModule()(*blocks, options));
  for (const DepthKeyframe& keyframe : keyframesAt(tile, input, options))
    volume->add(keyframe, input.depths(keyframe.number), input.pinhole);
  return canonicalMesh(volume->extract(), tile, options);
}

}  // namespace lodeline
