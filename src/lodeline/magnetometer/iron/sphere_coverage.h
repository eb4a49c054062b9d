#pragma once

#include <array>
#include <span>

#include "lodeline/types.h"

namespace lodeline {

/// Coverage of the sphere of directions by 72 bins of equal area: six zones of equal height in z with twelve
/// sectors each.
class SphereCoverage {
 public:
  static constexpr int kZones = 6;
  static constexpr int kSectors = 12;

  SphereCoverage() = default;
  explicit SphereCoverage(std::span<const Vec3> directions);

  void add(const Vec3& direction);
  int count(int zone, int sector) const { return counts_[static_cast<size_t>(zone * kSectors + sector)]; }
  /// Fraction of the bins with at least one direction.
  double share() const;

  /// Unit vector to the centre of a bin.
  static Vec3 middle(int zone, int sector);

 private:
  std::array<int, kZones * kSectors> counts_{};
};

}  // namespace lodeline
