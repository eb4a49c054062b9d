#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace lodeline {

/// Binary descriptor of the surroundings of an image point, 256 bits. Two are compared by the number of bits
/// that differ.
struct Descriptor {
  std::array<uint64_t, 4> bits{};

  bool operator==(const Descriptor&) const = default;
};

constexpr int kDescriptorBits = 256;

/// Number of bits that differ, 0 to 256.
inline int distanceOf(const Descriptor& a, const Descriptor& b) {
  int distance = 0;
  for (size_t i = 0; i < a.bits.size(); ++i) distance += std::popcount(a.bits[i] ^ b.bits[i]);
  return distance;
}

}  // namespace lodeline
