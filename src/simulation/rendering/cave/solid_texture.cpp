#include "simulation/rendering/cave/solid_texture.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "lodeline/util/simd_dispatch.h"
#include "simulation/rendering/cave/gradient_noise.h"
#include "simulation/rendering/optics/fast_exp.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

using Float4 = float __attribute__((vector_size(16)));
using Float8 = float __attribute__((vector_size(32)));
using Byte8 = int8_t __attribute__((vector_size(8)));
using Short8 = int16_t __attribute__((vector_size(16)));
using Int8 = int32_t __attribute__((vector_size(32)));

/// sum += weight * voxels. The conversion is done in steps, because compilers translate each widening into
/// one or two instructions, but the direct conversion into scalar code.
inline void addWeighted(const Byte8& voxels, const Float8& weight, Float8& sum) {
  const Int8 wide = __builtin_convertvector(__builtin_convertvector(voxels, Short8), Int8);
  sum += __builtin_convertvector(wide, Float8) * weight;
}

constexpr int kSize = 128;  // voxels along an edge; 8 MB of four bytes each
constexpr int kLevels = 6;

/// Slopes are stored up to this magnitude (m/m).
constexpr float kSlopeRange = 2.0f;

/// Reflectance and height of the rock at a voxel.
struct RockValue {
  float reflectance;
  float height;  ///< in tile lengths
};

/// Stains, roughness and cracks at a point of the unit tile.
RockValue rockValue(const Vec3f& p, uint32_t seed) {
  const Vec3f warp(gradientNoise(p * 6.0f, seed + 1, 6), gradientNoise(p * 6.0f, seed + 2, 6),
                   gradientNoise(p * 6.0f, seed + 3, 6));
  const Vec3f q = p + 0.03f * warp;
  const float stains = 0.55f * fractalNoise(q * 4.0f, 3, seed + 10, 0.75f, 4) +
                       0.60f * fractalNoise(q * 26.0f, 2, seed + 11, 0.9f, 26);
  const float crack = 1.0f - std::min(1.0f, std::abs(gradientNoise(q * 5.0f, seed + 30, 5)) / 0.03f);
  return {stains - 0.4f * crack, 0.020f * fractalNoise(q * 5.0f, 4, seed + 40, 0.6f, 5) - 0.010f * crack};
}

/// Balls distributed over the tile: dissolved pits, bright grains of shell and calcite.
struct Strewn {
  int count;
  float least_radius, greatest_radius;  ///< tile lengths
  RockValue change;                     ///< at the centre of a ball
};
constexpr Strewn kPits = {1700, 0.013f, 0.030f, {-0.75f, -0.016f}};
constexpr Strewn kGrains = {7400, 0.009f, 0.013f, {0.75f, 0.006f}};

/// Adds the balls to a periodic cube of n^3 values.
void strew(const Strewn& kind, Random random, int n, std::vector<RockValue>& values) {
  for (int ball = 0; ball < kind.count; ++ball) {
    const Vec3f centre =
        static_cast<float>(n) * Vec3(random.uniform(), random.uniform(), random.uniform()).cast<float>();
    const float radius = static_cast<float>(n * random.uniform(kind.least_radius, kind.greatest_radius));
    const int reach = static_cast<int>(radius) + 1;
    const Eigen::Vector3i middle = centre.cast<int>();
    for (int dz = -reach; dz <= reach; ++dz)
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
          const Eigen::Vector3i at = middle + Eigen::Vector3i(dx, dy, dz);
          const float share = smoothStep(radius, 0.6f * radius, (at.cast<float>() - centre).norm());
          if (share <= 0.0f) continue;
          const size_t z = at.z() & (n - 1), y = at.y() & (n - 1), x = at.x() & (n - 1);
          RockValue& value = values[(z * n + y) * n + x];
          value.reflectance += share * kind.change.reflectance;
          value.height += share * kind.change.height;
        }
  }
}

int8_t quantize(float value) {
  return static_cast<int8_t>(std::lround(127.0f * std::clamp(value, -1.0f, 1.0f)));
}

// The function with the largest share of the rendering time.
LODELINE_WIDE_VECTORS
TextureSample sampleLevels(const std::vector<TextureLevel>& levels, const Vec3f& point, float tile_m,
                           float footprint_m) {
  const float finest_m = tile_m / kSize;
  const float level = footprint_m <= finest_m ? 0.0f : std::max(0.0f, roughLog2(footprint_m / finest_m));
  if (level >= kLevels) return {};  // all details are finer than a pixel: returns the mean

  const auto trilinear = [&](int which) {
    const TextureLevel& grid = levels[which];
    const float scale = static_cast<float>(grid.size) / tile_m;
    // Voxel centres of a coarser level are between those of the finer one.
    const float shift = 0.5f * (1.0f - static_cast<float>(grid.size) / kSize);
    const float x = point.x() * scale - shift, y = point.y() * scale - shift, z = point.z() * scale - shift;
    const int ix = floorToInt(x), iy = floorToInt(y), iz = floorToInt(z);
    const float fx = x - ix, fy = y - iy, fz = z - iz;
    const int mask = grid.size - 1;
    // Two neighbours along x with four channels each, computed together.
    const float gx = 1.0f - fx;
    const Float8 along_x = {gx, gx, gx, gx, fx, fx, fx, fx};
    Float8 sum = {0, 0, 0, 0, 0, 0, 0, 0};
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 2; ++j) {
        const int line = ((iz + k) & mask) * grid.size + ((iy + j) & mask);
        Byte8 bytes;
        std::memcpy(&bytes, &grid.voxels[line * (grid.size + 1) + (ix & mask)], sizeof bytes);
        const float weight = (k ? fz : 1.0f - fz) * (j ? fy : 1.0f - fy);
        addWeighted(bytes, along_x * weight, sum);
      }
    return Float4{sum[0] + sum[4], sum[1] + sum[5], sum[2] + sum[6], sum[3] + sum[7]};
  };

  // Levels are blended only in the middle half of the interval between them, so half of the pixels need a
  // single level.
  const int lower = static_cast<int>(level);
  const float blend = std::clamp(2.0f * (level - static_cast<float>(lower)) - 0.5f, 0.0f, 1.0f);
  Float4 value = {0, 0, 0, 0};
  if (blend < 1.0f) value = trilinear(lower) * (1.0f - blend);
  // The coarsest level is blended with the mean.
  if (blend > 0.0f && lower + 1 < kLevels) value += trilinear(lower + 1) * blend;
  TextureSample sample;
  sample.reflectance = value[0] * (1.0f / 127.0f);
  sample.slope = Vec3f(value[1], value[2], value[3]) * (kSlopeRange / 127.0f);
  return sample;
}

}  // namespace

SolidTexture::SolidTexture(uint64_t seed) {
  const int n = kSize;
  std::vector<RockValue> values(static_cast<size_t>(n) * n * n);
  const auto index = [](int x, int y, int z) {
    return (static_cast<size_t>(z & (n - 1)) * n + (y & (n - 1))) * n + (x & (n - 1));
  };
  tbb::parallel_for(0, n, [&](int z) {
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        values[index(x, y, z)] =
            rockValue(Vec3f(x, y, z) / static_cast<float>(n), static_cast<uint32_t>(seed));
  });
  strew(kPits, Random(seed, "texture/pits"), n, values);
  strew(kGrains, Random(seed, "texture/grains"), n, values);
  double mean = 0.0;
  for (const RockValue& value : values) mean += value.reflectance;
  const float offset = static_cast<float>(mean / static_cast<double>(values.size()));

  levels_.push_back({n, std::vector<TextureLevel::Voxel>(static_cast<size_t>(n) * n * (n + 1))});
  tbb::parallel_for(0, n, [&](int z) {
    for (int y = 0; y < n; ++y)
      for (int x = 0; x <= n; ++x) {
        const float half = 0.5f * n / kSlopeRange;
        TextureLevel::Voxel& voxel = levels_[0].voxels[(static_cast<size_t>(z) * n + y) * (n + 1) + x];
        voxel.channel[0] = quantize(values[index(x, y, z)].reflectance - offset);
        voxel.channel[1] =
            quantize(half * (values[index(x + 1, y, z)].height - values[index(x - 1, y, z)].height));
        voxel.channel[2] =
            quantize(half * (values[index(x, y + 1, z)].height - values[index(x, y - 1, z)].height));
        voxel.channel[3] =
            quantize(half * (values[index(x, y, z + 1)].height - values[index(x, y, z - 1)].height));
      }
  });
  while (static_cast<int>(levels_.size()) < kLevels) addCoarserLevel();
}

void SolidTexture::addCoarserLevel() {
  const TextureLevel& fine = levels_.back();
  const int n = fine.size / 2;
  TextureLevel coarse{n, std::vector<TextureLevel::Voxel>(static_cast<size_t>(n) * n * (n + 1))};
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x <= n; ++x)
        for (int c = 0; c < 4; ++c) {
          int sum = 0;
          for (int corner = 0; corner < 8; ++corner) {
            const size_t line =
                static_cast<size_t>(2 * z + (corner >> 2)) * fine.size + 2 * y + (corner >> 1 & 1);
            sum += fine.voxels[line * (fine.size + 1) + 2 * (x % n) + (corner & 1)].channel[c];
          }
          coarse.voxels[(static_cast<size_t>(z) * n + y) * (n + 1) + x].channel[c] =
              static_cast<int8_t>(std::lround(sum / 8.0));
        }
  levels_.push_back(std::move(coarse));
}

TextureSample SolidTexture::sample(const Vec3f& point, float tile_m, float footprint_m) const {
  return sampleLevels(levels_, point, tile_m, footprint_m);
}

}  // namespace lodeline
