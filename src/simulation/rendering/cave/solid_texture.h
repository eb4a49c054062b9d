#pragma once

#include <cstdint>
#include <vector>

#include "simulation/rendering/optics/render_types.h"

namespace lodeline {

/// Rock texture at one point: reflectance relative to its mean, and the slope of the small-scale relief.
struct TextureSample {
  float reflectance = 0.0f;     ///< about -1..1, mean zero
  Vec3f slope = Vec3f::Zero();  ///< gradient of the relief (m/m), to be projected onto the surface
};

/// One level of the pyramid of a texture: a cube of voxels.
struct TextureLevel {
  struct Voxel {
    int8_t channel[4];  ///< reflectance, slope x y z; scaled by 127
  };
  int size = 0;
  std::vector<Voxel> voxels;  ///< x fastest; every row repeats its first voxel at its end
};

/// A precomputed cube of rock texture, repeated periodically in space: pits, cracks, grains and stains over
/// five octaves. Sampling it at several tile sizes gives detail from millimetres to metres. This costs only
/// memory reads, an order of magnitude less than evaluating noise for every pixel. A pyramid of box-filtered
/// copies (L. Williams, "Pyramidal parametrics", SIGGRAPH 1983) removes details finer than a pixel. The
/// texture thus does not flicker, and corners can be tracked.
class SolidTexture {
 public:
  explicit SolidTexture(uint64_t seed);

  /// Texture at `point` (m) for tiles of edge `tile_m`, averaged over about `footprint_m`.
  TextureSample sample(const Vec3f& point, float tile_m, float footprint_m) const;

 private:
  void addCoarserLevel();

  std::vector<TextureLevel> levels_;
};

}  // namespace lodeline
