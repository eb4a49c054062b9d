#include "simulation/rendering/cave/cave_layout.h"

#include <cmath>

namespace lodeline {

CaveLayout CaveLayout::translated(const Vec3& offset_W) const {
  CaveLayout moved;
  for (const Centerline& passage : passages) moved.passages.push_back(passage.translated(offset_W));
  return moved;
}

bool insidePassage(const Centerline& passage, const Vec3& point_W, double share) {
  const auto& stations = passage.stations();
  double nearest = 1e18;
  const PassageStation* station = nullptr;
  for (const PassageStation& s : stations) {
    const double squared = (s.position_W - point_W).squaredNorm();
    if (squared < nearest) {
      nearest = squared;
      station = &s;
    }
  }
  const Vec3 offset_W = point_W - station->position_W;
  // Beyond an open end, the nearest station is not beside the point.
  const double spacing_m = passage.length_m() / static_cast<double>(stations.size());
  if (std::abs(offset_W.dot(station->tangent_W)) > 2.0 * spacing_m) return false;
  const Vec3 left_W = Vec3::UnitZ().cross(station->tangent_W).normalized();
  const Vec3 above_W = station->tangent_W.cross(left_W);
  const double x = offset_W.dot(left_W) / (0.5 * share * station->width_m);
  const double z = offset_W.dot(above_W) / (0.5 * share * station->height_m);
  return x * x + z * z < 1.0;
}

}  // namespace lodeline
