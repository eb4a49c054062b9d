#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "simulation/rendering/cave/cave_layout.h"

namespace lodeline {

/// A surface point that a front end could track.
struct LandmarkPoint {
  Vec3 position_W = Vec3::Zero();
  Vec3 normal_W = Vec3::UnitZ();  ///< towards the open water
};

/// Surface points with a spatial search.
class LandmarkField {
 public:
  explicit LandmarkField(std::vector<LandmarkPoint> points);

  const std::vector<LandmarkPoint>& points() const { return points_; }

  /// Indices of all points within `radius_m`, in ascending order.
  std::vector<int> near(const Vec3& center_W, double radius_m) const;

 private:
  static constexpr double kCell_m = 2.0;
  int cellOf(double coordinate_m) const;

  std::vector<LandmarkPoint> points_;
  std::vector<std::pair<int, int>> by_column_;  // (slab along x, point), sorted
};

/// Points on the walls, floor and ceiling of a passage: an ellipse around each station, roughened by a tenth
/// of its radius.
LandmarkField passageLandmarks(const Centerline& centerline, double points_per_metre, uint64_t seed);

/// The same for all passages of a cave, without the points inside another passage.
LandmarkField caveLandmarks(const CaveLayout& cave, double points_per_metre, uint64_t seed);

}  // namespace lodeline
