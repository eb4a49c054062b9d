#include "simulation/sensors/landmark_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "simulation/shared/random.h"

namespace lodeline {

LandmarkField::LandmarkField(std::vector<LandmarkPoint> points) : points_(std::move(points)) {
  for (size_t i = 0; i < points_.size(); ++i) {
    by_column_.emplace_back(cellOf(points_[i].position_W.x()), static_cast<int>(i));
  }
  std::sort(by_column_.begin(), by_column_.end());
}

int LandmarkField::cellOf(double coordinate_m) const {
  return static_cast<int>(std::floor(coordinate_m / kCell_m));
}

std::vector<int> LandmarkField::near(const Vec3& center_W, double radius_m) const {
  const auto begin =
      std::lower_bound(by_column_.begin(), by_column_.end(), std::pair(cellOf(center_W.x() - radius_m), 0));
  const int last_cell = cellOf(center_W.x() + radius_m);
  std::vector<int> indices;
  for (auto it = begin; it != by_column_.end() && it->first <= last_cell; ++it) {
    const Vec3 offset = points_[it->second].position_W - center_W;
    if (offset.squaredNorm() <= radius_m * radius_m) indices.push_back(it->second);
  }
  std::sort(indices.begin(), indices.end());
  return indices;
}

namespace {

std::vector<LandmarkPoint> pointsAround(const Centerline& centerline, double points_per_metre,
                                        Random random) {
  const double begin = centerline.beginArcLength();
  const double length = centerline.endArcLength() - begin;
  std::vector<LandmarkPoint> points;
  const int count = static_cast<int>(length * points_per_metre);
  for (int i = 0; i < count; ++i) {
    const PassageStation station = centerline.at(begin + length * random.uniform());
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double rough = 1.0 + 0.1 * random.normal();
    const Vec3 left = Vec3::UnitZ().cross(station.tangent_W).normalized();
    const Vec3 above = station.tangent_W.cross(left);
    const double a = 0.5 * station.width_m, b = 0.5 * station.height_m;
    LandmarkPoint point;
    point.position_W =
        station.position_W + rough * (a * std::cos(angle) * left + b * std::sin(angle) * above);
    point.normal_W = -(std::cos(angle) / a * left + std::sin(angle) / b * above).normalized();
    points.push_back(point);
  }
  return points;
}

}  // namespace

LandmarkField passageLandmarks(const Centerline& centerline, double points_per_metre, uint64_t seed) {
  return LandmarkField(pointsAround(centerline, points_per_metre, Random(seed, "landmarks")));
}

LandmarkField caveLandmarks(const CaveLayout& cave, double points_per_metre, uint64_t seed) {
  // Points of a rough wall that sticks out into the other passage by a tenth of its radius stay.
  constexpr double kInside = 0.9;
  std::vector<LandmarkPoint> points;
  for (size_t k = 0; k < cave.passages.size(); ++k) {
    const std::string stream = k == 0 ? "landmarks" : "landmarks/" + std::to_string(k);
    for (const LandmarkPoint& point :
         pointsAround(cave.passages[k], points_per_metre, Random(seed, stream))) {
      bool inside = false;
      for (size_t other = 0; other < cave.passages.size(); ++other)
        inside = inside || (other != k && insidePassage(cave.passages[other], point.position_W, kInside));
      if (!inside) points.push_back(point);
    }
  }
  return LandmarkField(std::move(points));
}

}  // namespace lodeline
