#include "lodeline/mapping/recognition/verification/view_grid.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

constexpr double kCells = 48.0;

/// Positions of directions in a plane: at the angle from `axis`, rad.
std::vector<Vec2> laidOut(const std::vector<MapFeature>& features, const Vec3& axis) {
  const Mat32 basis = tangentBasis(axis);
  std::vector<Vec2> positions;
  for (const MapFeature& feature : features) {
    const Vec3& bearing = feature.rays.front().bearing_B;
    const Vec2 aside = basis.transpose() * bearing;
    const double sine = aside.norm();
    const double angle_rad = std::atan2(sine, axis.dot(bearing));
    positions.push_back(sine > 1e-9 ? Vec2(aside * (angle_rad / sine)) : Vec2::Zero());
  }
  return positions;
}

}  // namespace

ViewGrid::ViewGrid(const MapKeyframe& keyframe) {
  Vec3 sum = Vec3::Zero();
  for (const MapFeature& feature : keyframe.features) sum += feature.rays.front().bearing_B;
  if (keyframe.features.empty()) return;
  const Vec3 axis = sum.norm() > 1e-6 ? Vec3(sum.normalized()) : Vec3::UnitZ();
  const std::vector<Vec2> positions = laidOut(keyframe.features, axis);
  Vec2 least = positions.front(), most = positions.front();
  for (const Vec2& position : positions) {
    least = least.cwiseMin(position);
    most = most.cwiseMax(position);
  }
  const Vec2 extent = (most - least).cwiseMax(1e-3);
  const double side_rad = std::sqrt(extent.prod() / kCells);
  const int columns = static_cast<int>(extent.x() / side_rad) + 1;
  for (const Vec2& position : positions) {
    const Vec2 place = (position - least) / side_rad;
    cells_.push_back(static_cast<int>(place.y()) * columns + static_cast<int>(place.x()));
  }
  occupied_ = static_cast<int>(std::set<int>(cells_.begin(), cells_.end()).size());
  solid_angle_sr_ = occupied_ * side_rad * side_rad;
}

int ViewGrid::countCells(const std::vector<int>& features) const {
  std::set<int> cells;
  for (const int feature : features) cells.insert(cellOf(feature));
  return static_cast<int>(cells.size());
}

}  // namespace lodeline
