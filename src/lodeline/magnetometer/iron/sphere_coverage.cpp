#include "lodeline/magnetometer/iron/sphere_coverage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lodeline {

SphereCoverage::SphereCoverage(std::span<const Vec3> directions) {
  for (const Vec3& direction : directions) add(direction);
}

void SphereCoverage::add(const Vec3& direction) {
  const double norm = direction.norm();
  if (!(norm > 0.0)) return;
  const double turn = std::atan2(direction.y(), direction.x()) / (2.0 * std::numbers::pi) + 0.5;
  const int zone = std::clamp(static_cast<int>((direction.z() / norm + 1.0) / 2.0 * kZones), 0, kZones - 1);
  const int sector = std::clamp(static_cast<int>(turn * kSectors), 0, kSectors - 1);
  ++counts_[static_cast<size_t>(zone * kSectors + sector)];
}

double SphereCoverage::share() const {
  const auto visited = std::count_if(counts_.begin(), counts_.end(), [](int count) { return count > 0; });
  return static_cast<double>(visited) / static_cast<double>(counts_.size());
}

Vec3 SphereCoverage::middle(int zone, int sector) {
  const double z = (zone + 0.5) * 2.0 / kZones - 1.0;
  const double angle = ((sector + 0.5) / kSectors - 0.5) * 2.0 * std::numbers::pi;
  const double radius = std::sqrt(1.0 - z * z);
  return Vec3(radius * std::cos(angle), radius * std::sin(angle), z);
}

}  // namespace lodeline
