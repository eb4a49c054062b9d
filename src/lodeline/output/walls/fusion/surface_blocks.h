#pragma once

#include <optional>
#include <vector>

#include "lodeline/output/walls/fusion/tile_fusion.h"

namespace lodeline {

/// Blocks near the surfaces of a tile and one block around it, in a fixed order, that at least `min_views`
/// keyframes saw. Empty where there are more than `max_blocks`.
std::optional<std::vector<Eigen::Vector3i>> surfaceBlocks(const Tile& tile, const DepthKeyframes& input,
                                                          const FusionOptions& options);

/// Keyframes whose box meets a tile with one block around it.
std::vector<DepthKeyframe> keyframesAt(const Tile& tile, const DepthKeyframes& input,
                                       const FusionOptions& options);

}  // namespace lodeline
