#include "lodeline/output/walls/wall_work.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

constexpr int kFormat = 2;  ///< of the files of unfinished work, and of how they are computed

/// Hash of bytes (FNV-1a, 64 bit).
class Hash {
 public:
  void add(double value) {
    const auto* bytes = reinterpret_cast<const uint8_t*>(&value);
    for (size_t i = 0; i < sizeof(value); ++i) hash_ = (hash_ ^ bytes[i]) * 0x100000001B3ULL;
  }
  void add(const Rigid3& pose) {
    for (const double value : pose.translation) add(value);
    for (const double value : pose.rotation.coeffs()) add(value);
  }
  uint64_t value() const { return hash_; }

 private:
  uint64_t hash_ = 0xCBF29CE484222325ULL;
};

std::string cameraText(const CameraCalibration& camera) {
  Hash hash;
  hash.add(camera.body_from_camera);
  for (const double value :
       {camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px, camera.time_offset_to_imu_s})
    hash.add(value);
  for (const double value : camera.distortion) hash.add(value);
  if (camera.port) {
    for (const Vec3& vector : {camera.port->normal_C, camera.port->centre_C})
      for (const double value : vector) hash.add(value);
    for (const double value : {camera.port->distance_m, camera.port->radius_m, camera.port->thickness_m,
                               camera.port->index_air, camera.port->index_glass, camera.port->index_water})
      hash.add(value);
  }
  return fmt::format("camera {} {} {}x{} {:x} {}\n", camera.name, camera.model, camera.width_px,
                     camera.height_px, hash.value(), camera.mask_file);
}

std::vector<Tile> eighths(const Tile& tile) {
  std::vector<Tile> parts;
  const Eigen::Vector3i half = (tile.high - tile.low) / 2;
  for (int part = 0; part < 8; ++part) {
    Tile eighth = tile;
    for (int axis = 0; axis < 3; ++axis) {
      const int middle = tile.low[axis] + half[axis];
      (part >> axis & 1 ? eighth.low : eighth.high)[axis] = middle;
    }
    parts.push_back(eighth);
  }
  return parts;
}

void fuseInto(const Tile& tile, const DepthKeyframes& frames, const FusionOptions& options,
              const std::filesystem::path& work, WallTiles* tiles) {
  const std::filesystem::path file = work / fmt::format("tile_{}_{}_{}_{}.mesh", tile.low.x(), tile.low.y(),
                                                        tile.low.z(), tile.high.x() - tile.low.x());
  if (std::filesystem::exists(file)) {
    tiles->add(file, readTileFile(file));
    return;
  }
  const std::optional<WallMesh> mesh = fuseTile(tile, frames, options);
  if (mesh) {
    writeTileFile(*mesh, file);
    tiles->add(file, *mesh);
    return;
  }
  if (tile.high.x() - tile.low.x() < 2)
    throw InputError(
        "walls: a single block needs more memory than all may take; take larger voxels (--voxel)");
  for (const Tile& part : eighths(tile)) fuseInto(part, frames, options, work, tiles);
}

}  // namespace

std::string wallInput(const DiveMap& map, const std::vector<CameraCalibration>& cameras,
                      const WallOptions& options) {
  const auto& [steps, rectification, depth] = options.depths;
  const FusionOptions& fusion = options.fusion;
  std::string text = fmt::format(
      "format {}\nrun {}\nsteps {} {}\nrectification {} {} {}\ndepth {} {} {} {}\nfusion {} {} {} {} {}\n",
      kFormat, map.run_folder.string(), steps.step_m, steps.step_rad, rectification.max_width_px,
      rectification.max_angle_rad, rectification.nominal_distance_m, depth.nearest_m, depth.max_sigma_m,
      depth.disparity_sigma_px, depth.min_texture, fusion.voxel_m, fusion.truncation_voxels, fusion.min_views,
      fusion.max_blocks, fusion.min_part_triangles);
  for (const CameraCalibration& camera : cameras) text += cameraText(camera);
  Hash hash;
  for (const StampedPose& pose : map.trajectory.poses) {
    hash.add(pose.time.seconds());
    hash.add(pose.world_from_body);
  }
  return text + fmt::format("poses {} {:x}\n", map.trajectory.size(), hash.value());
}

void claimWork(const std::filesystem::path& work, const std::string& input) {
  const std::filesystem::path file = work / "input.txt";
  std::ifstream stream(file, std::ios::binary);
  const std::string earlier{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (stream && earlier == input) return;
  std::error_code error;
  std::filesystem::remove_all(work, error);
  createOutputFolder(work);
  writeWhole(file, input);
}

std::optional<WallTiles> fuseTiles(const DiveDepths& depths, int tile_blocks, const FusionOptions& options,
                                   const std::filesystem::path& work, const WallProgress& progress) {
  WallTiles tiles;
  size_t done = 0;
  for (const std::array<int, 3>& place : depths.tiles) {
    if (!progress("surface", static_cast<double>(done++) / static_cast<double>(depths.tiles.size())))
      return std::nullopt;
    const Eigen::Vector3i low = tile_blocks * Eigen::Vector3i(place[0], place[1], place[2]);
    fuseInto({low, low.array() + tile_blocks}, depths.frames, options, work, &tiles);
  }
  return tiles;
}

}  // namespace lodeline
