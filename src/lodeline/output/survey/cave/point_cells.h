#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Points in cubes of one edge length, for a search among points that are added one by one.
class PointCells {
 public:
  explicit PointCells(double edge_m) : edge_m_(edge_m) {}

  void add(size_t index, const Vec3& position) {
    cells_[keyOf((position / edge_m_).array().floor())].push_back({index, position});
  }

  /// Whether a point lies within a distance, at most the edge of a cube.
  bool hasWithin(const Vec3& position, double distance_m) const {
    const Eigen::Array3d cell = (position / edge_m_).array().floor();
    for (int i = 0; i < 27; ++i) {
      const int x = i % 3 - 1, y = i / 3 % 3 - 1, z = i / 9 - 1;
      const auto found = cells_.find(keyOf(cell + Eigen::Array3d(x, y, z)));
      if (found == cells_.end()) continue;
      for (const Point& point : found->second) {
        if ((point.position - position).norm() <= distance_m) return true;
      }
    }
    return false;
  }

 private:
  struct Point {
    size_t index;
    Vec3 position;
  };

  /// Cubes far from each other may share a key; the distances of their points tell them apart.
  static uint64_t keyOf(const Eigen::Array3d& cell) {
    uint64_t key = 0;
    for (double value : cell) key = key * 0x9E3779B97F4A7C15ULL + static_cast<uint64_t>(std::llround(value));
    return key;
  }

  double edge_m_;
  std::unordered_map<uint64_t, std::vector<Point>> cells_;
};

}  // namespace lodeline
