#include "simulation/rendering/cave/gradient_noise.h"

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

int wrap(int i, int period) {
  if (period <= 0) return i;
  const int rest = i % period;
  return rest < 0 ? rest + period : rest;
}

uint32_t latticeHash(int x, int y, int z, uint32_t seed) {
  uint32_t h = seed * 0x9E3779B1u;
  h ^= static_cast<uint32_t>(x) * 0x85EBCA77u;
  h = (h << 13 | h >> 19) * 0xC2B2AE3Du;
  h ^= static_cast<uint32_t>(y) * 0x27D4EB2Fu;
  h = (h << 13 | h >> 19) * 0x165667B1u;
  h ^= static_cast<uint32_t>(z) * 0x9E3779B1u;
  h ^= h >> 15;
  h *= 0x85EBCA77u;
  return h ^ (h >> 13);
}

/// Scalar product with one of the twelve cube-edge directions.
float gradientDot(uint32_t hash, float x, float y, float z) {
  const uint32_t h = hash & 15;
  const float u = h < 8 ? x : y;
  const float v = h < 4 ? y : (h == 12 || h == 14 ? x : z);
  return ((h & 1) ? -u : u) + ((h & 2) ? -v : v);
}

float fade(float t) { return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f); }

}  // namespace

float gradientNoise(const Vec3f& point, uint32_t seed, int period) {
  const int x0 = floorToInt(point.x()), y0 = floorToInt(point.y()), z0 = floorToInt(point.z());
  const float x = point.x() - x0, y = point.y() - y0, z = point.z() - z0;
  const int ix[2] = {wrap(x0, period), wrap(x0 + 1, period)};
  const int iy[2] = {wrap(y0, period), wrap(y0 + 1, period)};
  const int iz[2] = {wrap(z0, period), wrap(z0 + 1, period)};
  const float u = fade(x), v = fade(y), w = fade(z);
  float plane[2];
  for (int k = 0; k < 2; ++k) {
    const float a = gradientDot(latticeHash(ix[0], iy[0], iz[k], seed), x, y, z - k);
    const float b = gradientDot(latticeHash(ix[1], iy[0], iz[k], seed), x - 1, y, z - k);
    const float c = gradientDot(latticeHash(ix[0], iy[1], iz[k], seed), x, y - 1, z - k);
    const float d = gradientDot(latticeHash(ix[1], iy[1], iz[k], seed), x - 1, y - 1, z - k);
    plane[k] = lerp(lerp(a, b, u), lerp(c, d, u), v);
  }
  return lerp(plane[0], plane[1], w);
}

float fractalNoise(const Vec3f& point, int octaves, uint32_t seed, float gain, int period) {
  float sum = 0.0f, amplitude = 1.0f, frequency = 1.0f;
  for (int i = 0; i < octaves; ++i) {
    const int octave_period = period > 0 ? period << i : 0;
    sum += amplitude * gradientNoise(point * frequency, seed + 101u * i, octave_period);
    amplitude *= gain;
    frequency *= 2.0f;
  }
  return sum;
}

float ridgedNoise(const Vec3f& point, int octaves, uint32_t seed, float gain, int period) {
  float sum = 0.0f, total = 0.0f, amplitude = 1.0f, frequency = 1.0f;
  for (int i = 0; i < octaves; ++i) {
    const int octave_period = period > 0 ? period << i : 0;
    const float noise = gradientNoise(point * frequency, seed + 101u * i, octave_period);
    sum += amplitude * (1.0f - 2.0f * std::abs(noise));
    total += amplitude;
    amplitude *= gain;
    frequency *= 2.0f;
  }
  return sum / total;
}

CellDistances cellNoise(const Vec3f& point, uint32_t seed, int period) {
  const int x0 = floorToInt(point.x()), y0 = floorToInt(point.y()), z0 = floorToInt(point.z());
  CellDistances result;
  float nearest = 1e9f, second = 1e9f;
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const uint32_t h =
            latticeHash(wrap(x0 + i, period), wrap(y0 + j, period), wrap(z0 + k, period), seed);
        const Vec3f feature(x0 + i + (h & 1023) / 1024.0f, y0 + j + ((h >> 10) & 1023) / 1024.0f,
                            z0 + k + ((h >> 20) & 1023) / 1024.0f);
        const float squared = (feature - point).squaredNorm();
        if (squared < nearest) {
          second = nearest;
          nearest = squared;
          result.nearest_id = h;
        } else if (squared < second) {
          second = squared;
        }
      }
  result.nearest = std::sqrt(nearest);
  result.second = std::sqrt(second);
  return result;
}

}  // namespace lodeline
