#include "lodeline/output/walls/fusion/surface_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace lodeline {
namespace {

using Block = std::array<int, 3>;

/// Blocks that one keyframe's points touch, sorted.
std::vector<Block> touchedBlocks(const Tile& reach, const DepthKeyframe& keyframe, const DepthImage& image,
                                 const PinholeView& pinhole, const FusionOptions& options) {
  constexpr int kStep_px = 3;
  const double block_m = options.block_m(), truncation_m = options.truncation_m();
  std::vector<Block> blocks;
  for (int v = 0; v < image.depth.rows; v += kStep_px) {
    for (int u = 0; u < image.depth.cols; u += kStep_px) {
      const double depth_m = image.depth_m(u, v);
      if (depth_m <= 0.0) continue;
      const Vec3 direction = keyframe.map_from_view.rotation * pinhole.direction(u, v);
      const double half = truncation_m / direction.norm();  // along z, for the truncation along the ray
      const int steps = static_cast<int>(std::ceil(2.0 * truncation_m / (0.5 * block_m)));
      for (int i = 0; i <= steps; ++i) {
        const Vec3 point =
            keyframe.map_from_view.translation + (depth_m + half * (2.0 * i / steps - 1.0)) * direction;
        const Eigen::Vector3i block = (point / block_m).array().floor().cast<int>();
        if (reach.contains(block)) blocks.push_back({block.x(), block.y(), block.z()});
      }
    }
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

}  // namespace

std::vector<DepthKeyframe> keyframesAt(const Tile& tile, const DepthKeyframes& input,
                                       const FusionOptions& options) {
  const Tile reach = tile.expanded(1);
  const double margin_m = options.truncation_m();
  const Eigen::AlignedBox3d box(reach.low.cast<double>() * options.block_m() - Vec3::Constant(margin_m),
                                reach.high.cast<double>() * options.block_m() + Vec3::Constant(margin_m));
  std::vector<DepthKeyframe> found;
  for (const DepthKeyframe& keyframe : input.keyframes) {
    if (!keyframe.box.isEmpty() && keyframe.box.intersects(box)) found.push_back(keyframe);
  }
  return found;
}

std::optional<std::vector<Eigen::Vector3i>> surfaceBlocks(const Tile& tile, const DepthKeyframes& input,
                                                          const FusionOptions& options) {
  // Single blocks of particles must not take the memory that the limit allows.
  const size_t most_touched = 8 * options.max_blocks;
  std::map<Block, int> views;
  for (const DepthKeyframe& keyframe : keyframesAt(tile, input, options)) {
    const DepthImage image = input.depths(keyframe.number);
    for (const Block& block : touchedBlocks(tile.expanded(1), keyframe, image, input.pinhole, options))
      ++views[block];
    if (views.size() > most_touched) return std::nullopt;
  }
  std::vector<Eigen::Vector3i> blocks;
  for (const auto& [block, count] : views) {
    if (count >= options.min_views) blocks.emplace_back(block[0], block[1], block[2]);
  }
  if (blocks.size() > options.max_blocks) return std::nullopt;
  return blocks;
}

}  // namespace lodeline
