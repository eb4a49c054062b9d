#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "lodeline/output/walls/depth/depth_image.h"
#include "lodeline/output/walls/fusion/wall_mesh.h"

namespace lodeline {

/// Voxels along each edge of a block.
inline constexpr int kBlockVoxels = 8;

struct FusionOptions {
  double voxel_m = 0.02;
  double truncation_voxels = 5.0;   ///< half thickness of the volume about the surface
  int min_views = 3;                ///< keyframes that must see a voxel near a surface; fewer are particles
  size_t max_blocks = 16'000;       ///< of one volume, which bounds the memory: about 11 kB a block
  size_t min_part_triangles = 100;  ///< smaller separate parts are left out

  double block_m() const { return kBlockVoxels * voxel_m; }
  double truncation_m() const { return truncation_voxels * voxel_m; }
};

/// A box of blocks, `low` inside and `high` outside, in blocks of FusionOptions::block_m().
struct Tile {
  Eigen::Vector3i low = Eigen::Vector3i::Zero(), high = Eigen::Vector3i::Zero();

  bool contains(const Eigen::Vector3i& block) const {
    return (block.array() >= low.array()).all() && (block.array() < high.array()).all();
  }
  Tile expanded(int blocks) const { return {low.array() - blocks, high.array() + blocks}; }
};

/// A keyframe with depths: its place, and the box about its camera and all its points.
struct DepthKeyframe {
  size_t number = 0;
  Time time;
  Rigid3 map_from_view;
  Eigen::AlignedBox3d box;
};

/// What fuseTile() reads.
struct DepthKeyframes {
  PinholeView pinhole;
  std::vector<DepthKeyframe> keyframes;
  std::function<DepthImage(size_t number)> depths;
};

/// Whether the module with Open3D, which fuses depths, can be loaded.
bool hasOpen3d();

/// The surface in a tile: depths of all keyframes in a truncated signed distance volume (B. Curless, M.
/// Levoy, "A volumetric method for building complex models from range images", SIGGRAPH 1996) with weights
/// 1/sigma^2, extracted by marching cubes. Blocks and voxels that fewer than `min_views` keyframes saw near a
/// surface are left out, and voxels whose joint distance has a sigma above 3 cm; keyframes that look
/// through a voxel vote against it. Neighbouring tiles have equal vertices where they meet. Empty where the
/// volume would need more than `max_blocks`: the tile must then be divided. The same input gives the same
/// bytes. Throws UsageError without Open3D.
std::optional<WallMesh> fuseTile(const Tile& tile, const DepthKeyframes& input, const FusionOptions& options);

}  // namespace lodeline
