#pragma once

#include <memory>
#include <vector>

#include "lodeline/output/walls/fusion/tile_fusion.h"

namespace lodeline {

/// A truncated signed distance volume of some blocks. Open3D holds it, with 40 further libraries. They are in
/// a module that the first volume loads, so that no other work waits for them or has them in memory.
class WallVolume {
 public:
  virtual ~WallVolume() = default;
  virtual void add(const DepthKeyframe& keyframe, const DepthImage& image, const PinholeView& pinhole) = 0;
  /// The surface. Ends the volume: nothing may be added afterwards.
  virtual WallMesh extract() = 0;
};

/// The function of the module: a new volume of blocks in lexicographic order. The caller owns it.
using MakeWallVolume = WallVolume*(const std::vector<Eigen::Vector3i>& blocks, const FusionOptions& options);

/// Loads the module where it is not loaded yet. Throws UsageError, naming the reason, where that fails.
MakeWallVolume& wallVolumeModule();

}  // namespace lodeline
