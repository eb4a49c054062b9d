#pragma once

#include <cstdint>

#include "simulation/rendering/optics/render_types.h"

namespace lodeline {

/// The largest integer that does not exceed x.
inline int floorToInt(float x) {
  const int truncated = static_cast<int>(x);
  return truncated - (static_cast<float>(truncated) > x ? 1 : 0);
}

/// Gradient noise (K. Perlin, "Improving noise", SIGGRAPH 2002) with hashed lattice gradients instead of a
/// permutation table. It is smooth, zero at lattice points, about -1..1, with one feature per unit length. A
/// `period` above zero makes it periodic along every axis.
float gradientNoise(const Vec3f& point, uint32_t seed, int period = 0);

/// Sum of layers of gradient noise. Each layer has twice the frequency and `gain` times the amplitude of the
/// one before; the first has amplitude 1.
float fractalNoise(const Vec3f& point, int octaves, uint32_t seed, float gain = 0.5f, int period = 0);

/// Like fractalNoise with layers 1 - 2|noise|: sharp ridges where the noise changes sign (F. K. Musgrave in
/// Ebert et al., "Texturing and Modeling", chapter 16). About -1..1.
float ridgedNoise(const Vec3f& point, int octaves, uint32_t seed, float gain = 0.5f, int period = 0);

/// Distances to the nearest and second-nearest of random points, one per unit cell (S. Worley, "A cellular
/// texture basis function", SIGGRAPH 1996).
struct CellDistances {
  float nearest = 0.0f;
  float second = 0.0f;
  uint32_t nearest_id = 0;  ///< hash of the nearest point, for a random property of its cell
};
CellDistances cellNoise(const Vec3f& point, uint32_t seed, int period = 0);

}  // namespace lodeline
