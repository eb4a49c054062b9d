#include <open3d/core/hashmap/HashMap.h>
#include <open3d/t/geometry/VoxelBlockGrid.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "lodeline/output/walls/fusion/wall_volume.h"

// The module lodeline_open3d.

namespace lodeline {
namespace {

namespace o3 = open3d;

constexpr int kVoxels = kBlockVoxels * kBlockVoxels * kBlockVoxels;
/// Least sum of the weights of a voxel (1 for 1 cm): one sigma of its joint distance is 3 cm. With 2 cm the
/// cloud is more exact, but far walls and most cross-sections are missing (docs/lab-notes/walls.md).
constexpr float kLeastWeight = 1.0F / 9.0F;

/// The values of one block in Open3D's memory, and the number of keyframes that saw each voxel near a
/// surface.
struct BlockValues {
  Eigen::Vector3i block;
  float* distance = nullptr;  ///< over the truncation, positive in the water
  float* weight = nullptr;
  float* colour = nullptr;  ///< red, green, blue
  std::vector<uint16_t> views = std::vector<uint16_t>(kVoxels, 0);
};

/// A keyframe as float numbers for the inner loop.
class Projection {
 public:
  Projection(const DepthKeyframe& keyframe, const PinholeView& pinhole)
      : rotation_(keyframe.map_from_view.rotation.conjugate().toRotationMatrix().cast<float>()),
        translation_(keyframe.map_from_view.inverse().translation.cast<float>()),
        focal_px_(static_cast<float>(pinhole.focal_px)),
        centre_px_(pinhole.centre_px.cast<float>()) {}

  Eigen::Vector3f toView(const Eigen::Vector3f& point) const { return rotation_ * point + translation_; }
  const Eigen::Matrix3f& rotation() const { return rotation_; }
  /// Nearest pixel of a point of the view in front of it.
  Eigen::Vector2i pixel(const Eigen::Vector3f& point_V) const {
    const float scale_px = focal_px_ / point_V.z();
    return {nearest(scale_px * point_V.x() + centre_px_.x()),
            nearest(scale_px * point_V.y() + centre_px_.y())};
  }

 private:
  /// Nearest integer of a number above -2^14, without a call.
  static int nearest(float x) {
    constexpr int kShift = 1 << 14;
    return static_cast<int>(std::max(x, -16000.0F) + (static_cast<float>(kShift) + 0.5F)) - kShift;
  }

  Eigen::Matrix3f rotation_;
  Eigen::Vector3f translation_;
  float focal_px_;
  Eigen::Vector2f centre_px_;
};

class Open3dVolume final : public WallVolume {
 public:
  Open3dVolume(const std::vector<Eigen::Vector3i>& blocks, const FusionOptions& options)
      : options_(options),
        grid_({"tsdf", "weight", "color"}, {o3::core::Float32, o3::core::Float32, o3::core::Float32},
              {{1}, {1}, {3}}, static_cast<float>(options.voxel_m), kBlockVoxels,
              static_cast<int64_t>(blocks.size()) + 2, o3::core::Device("CPU:0")) {
    std::vector<int> keys;
    for (const Eigen::Vector3i& block : blocks) keys.insert(keys.end(), block.data(), block.data() + 3);
    const o3::core::Tensor coordinates(keys, {static_cast<int64_t>(blocks.size()), 3}, o3::core::Int32);
    // Open3D 0.16 asserts that no voxel beside a surface is the first one of its memory. A block far from
    // everything gets that one.
    grid_.GetHashMap().Activate(o3::core::Tensor(std::vector<int>(3, 1 << 20), {1, 3}, o3::core::Int32));
    grid_.GetHashMap().Activate(coordinates);
    for (const char* name : {"tsdf", "weight", "color"}) grid_.GetAttribute(name).Fill(0.0F);
    const auto [places, found] = grid_.GetHashMap().Find(coordinates);
    const std::vector<int> indices = places.To(o3::core::Int32).ToFlatVector<int>();
    auto* distances = grid_.GetAttribute("tsdf").GetDataPtr<float>();
    auto* weights = grid_.GetAttribute("weight").GetDataPtr<float>();
    auto* colours = grid_.GetAttribute("color").GetDataPtr<float>();
    for (size_t i = 0; i < blocks.size(); ++i) {
      const auto first = static_cast<size_t>(indices[i]) * kVoxels;
      blocks_.push_back({blocks[i], distances + first, weights + first, colours + 3 * first});
    }
  }

  void add(const DepthKeyframe& keyframe, const DepthImage& image, const PinholeView& pinhole) override {
    const Projection projection(keyframe, pinhole);
    tbb::parallel_for(size_t{0}, blocks_.size(), [&](size_t i) {
      if (mayShow(blocks_[i], projection, image.depth.size())) addTo(&blocks_[i], projection, image);
    });
  }

  WallMesh extract() override {
    for (BlockValues& block : blocks_) {
      for (int i = 0; i < kVoxels; ++i) {
        if (block.views[static_cast<size_t>(i)] < options_.min_views || block.weight[i] < kLeastWeight)
          block.weight[i] = 0.0F;
      }
    }
    const o3::t::geometry::TriangleMesh mesh = grid_.ExtractTriangleMesh(0.0F, -1);
    WallMesh result;
    if (!mesh.HasVertexPositions() || !mesh.HasTriangleIndices()) return result;
    const std::vector<float> positions = mesh.GetVertexPositions().ToFlatVector<float>();
    const std::vector<float> colours = mesh.GetVertexColors().ToFlatVector<float>();
    const std::vector<int> corners = mesh.GetTriangleIndices().To(o3::core::Int32).ToFlatVector<int>();
    for (size_t i = 0; i + 2 < positions.size(); i += 3) {
      result.positions.emplace_back(positions[i], positions[i + 1], positions[i + 2]);
      std::array<uint8_t, 3> colour{};
      for (size_t c = 0; c < 3; ++c)
        colour[c] = static_cast<uint8_t>(std::clamp(std::lround(255.0F * colours[i + c]), 0L, 255L));
      result.colours.push_back(colour);
      result.views.push_back(viewsAt(result.positions.back()));
    }
    for (size_t i = 0; i + 2 < corners.size(); i += 3) {
      result.triangles.push_back({static_cast<uint32_t>(corners[i]), static_cast<uint32_t>(corners[i + 1]),
                                  static_cast<uint32_t>(corners[i + 2])});
    }
    return result;
  }

 private:
  /// Whether part of a block may be in the image.
  bool mayShow(const BlockValues& block, const Projection& projection, cv::Size size) const {
    const auto edge_m = static_cast<float>(options_.block_m());
    const Eigen::Vector3f centre =
        projection.toView((block.block.cast<float>() + Eigen::Vector3f::Constant(0.5F)) * edge_m);
    const float radius_m = 0.87F * edge_m;
    if (centre.z() < radius_m + 0.1F || centre.z() > DepthImage::kMaxDepth_m + radius_m) return false;
    const Eigen::Vector2i pixel = projection.pixel(centre);
    const Eigen::Vector2i border =
        projection.pixel({radius_m, radius_m, centre.z() - radius_m}) - projection.pixel({0.0F, 0.0F, 1.0F});
    return pixel.x() > -border.x() && pixel.y() > -border.y() && pixel.x() < size.width + border.x() &&
           pixel.y() < size.height + border.y();
  }

  void addTo(BlockValues* block, const Projection& projection, const DepthImage& image) const {
    const auto voxel_m = static_cast<float>(options_.voxel_m);
    const Eigen::Vector3f step_x = voxel_m * projection.rotation().col(0);
    int i = 0;
    for (int z = 0; z < kBlockVoxels; ++z) {
      for (int y = 0; y < kBlockVoxels; ++y) {
        const Eigen::Vector3i first = kBlockVoxels * block->block + Eigen::Vector3i(0, y, z);
        Eigen::Vector3f point_V = projection.toView(first.cast<float>() * voxel_m);
        for (int x = 0; x < kBlockVoxels; ++x, ++i, point_V += step_x)
          addToVoxel(block, i, point_V, projection.pixel(point_V), image);
      }
    }
  }

  void addToVoxel(BlockValues* block, int i, const Eigen::Vector3f& point_V, const Eigen::Vector2i& pixel,
                  const DepthImage& image) const {
    if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() >= image.depth.cols || pixel.y() >= image.depth.rows)
      return;
    const uint16_t raw = image.depth.at<uint16_t>(pixel.y(), pixel.x());
    if (raw == 0) return;
    const auto truncation_m = static_cast<float>(options_.truncation_m());
    const auto depth_m = static_cast<float>(raw * DepthImage::kDepthUnit_m);
    // Distance along the ray of the pixel.
    const float ahead_m = (depth_m - point_V.z()) * point_V.norm() / point_V.z();
    if (ahead_m < -truncation_m) return;
    const float sigma = image.sigma.at<uint8_t>(pixel.y(), pixel.x());
    const float distance = std::min(1.0F, ahead_m / truncation_m);
    // 1 for 1 cm.
    const float weight = 100.0F / (sigma * sigma);
    const float sum = block->weight[i] + weight;
    block->distance[i] += weight / sum * (distance - block->distance[i]);
    if (distance < 1.0F) {
      ++block->views[static_cast<size_t>(i)];
      addColour(block->colour + 3 * i, weight / sum, pixel, image.colour);
    }
    block->weight[i] = sum;
  }

  static void addColour(float* colour, float share, const Eigen::Vector2i& pixel, const cv::Mat& image) {
    if (image.channels() == 1) {
      const float grey = image.at<uint8_t>(pixel.y(), pixel.x());
      for (int c = 0; c < 3; ++c) colour[c] += share * (grey - colour[c]);
    } else {
      const auto& bgr = image.at<cv::Vec3b>(pixel.y(), pixel.x());
      for (int c = 0; c < 3; ++c) colour[c] += share * (static_cast<float>(bgr[2 - c]) - colour[c]);
    }
  }

  /// Views of the voxel next to a point; the blocks are in lexicographic order.
  uint16_t viewsAt(const Eigen::Vector3f& point) const {
    const Eigen::Vector3i voxel = (point / static_cast<float>(options_.voxel_m)).array().round().cast<int>();
    const Eigen::Vector3i block = (voxel.cast<float>() / kBlockVoxels).array().floor().cast<int>();
    const auto isBefore = [](const BlockValues& a, const Eigen::Vector3i& b) {
      return std::lexicographical_compare(a.block.data(), a.block.data() + 3, b.data(), b.data() + 3);
    };
    const auto found = std::lower_bound(blocks_.begin(), blocks_.end(), block, isBefore);
    if (found == blocks_.end() || found->block != block) return 0;
    const Eigen::Vector3i local = voxel - kBlockVoxels * block;
    return found
        ->views[static_cast<size_t>(local.x() + kBlockVoxels * (local.y() + kBlockVoxels * local.z()))];
  }

  FusionOptions options_;
  o3::t::geometry::VoxelBlockGrid grid_;
  std::vector<BlockValues> blocks_;
};

}  // namespace

}  // namespace lodeline

extern "C" lodeline::WallVolume* lodelineMakeWallVolume(const std::vector<Eigen::Vector3i>& blocks,
                                                        const lodeline::FusionOptions& options) {
  return new lodeline::Open3dVolume(blocks, options);
}
