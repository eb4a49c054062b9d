#pragma once

#include <cstdint>

namespace lodeline {

/// Hash of 64 bits: the finalizer of SplitMix64 (Steele, Lea and Flood, OOPSLA 2014). Equal inputs give equal
/// outputs on every machine, so images do not depend on the order of their pixels.
inline uint64_t scrambleBits(uint64_t x) {
  x += 0x9E3779B97F4A7C15ull;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
  return x ^ (x >> 31);
}

/// Combines several numbers into one hash, e.g. seed, camera and frame.
inline uint64_t combineHash(uint64_t a, uint64_t b) { return scrambleBits(a ^ scrambleBits(b)); }

/// Uniform number in [0, 1) from the upper bits of a hash.
inline double uniformFromHash(uint64_t hash) { return static_cast<double>(hash >> 11) * 0x1.0p-53; }

/// Approximately standard normal number from one hash: the sum of four uniform 16-bit numbers (Irwin-Hall),
/// limited to 3.5 sigma. It is fast enough for one draw per pixel.
inline float roughNormalFromHash(uint64_t hash) {
  const int sum = static_cast<int>(hash & 0xFFFF) + static_cast<int>((hash >> 16) & 0xFFFF) +
                  static_cast<int>((hash >> 32) & 0xFFFF) + static_cast<int>(hash >> 48);
  // Four uniforms of variance 65536^2 / 12 each: sigma = 65536 / sqrt(3).
  return static_cast<float>(sum - 131070) * (1.7320508f / 65536.0f);
}

}  // namespace lodeline
