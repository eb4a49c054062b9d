#include "lodeline/mapping/recognition/keypoints/scene_distance.h"

#include <algorithm>
#include <cmath>

namespace lodeline {

SceneDistance::SceneDistance(const std::vector<MapFeature>& tracked, double focal_px) : focal_px_(focal_px) {
  for (const MapFeature& feature : tracked) {
    if (!feature.point_B) continue;
    const BodyRay& ray = feature.rays.front();
    points_.push_back({ray.pixel, 1.0 / (*feature.point_B - ray.origin_B).norm()});
  }
}

ExpectedDistance SceneDistance::at(const Vec2& pixel) const {
  // Beyond this angle another rock may be there; the surface between the points bends by some percent.
  constexpr double kAround_rad = 0.1, kSoftening_rad = 0.02, kBend = 0.05, kMostSpread = 0.1;
  constexpr size_t kNeighbours = 4;
  ExpectedDistance expected;
  if (points_.empty()) return expected;
  std::vector<std::pair<double, double>> nearest;  // squared distance in the image, inverse distance
  for (const Point& point : points_)
    nearest.emplace_back((point.pixel - pixel).squaredNorm() / (focal_px_ * focal_px_), point.inverse_per_m);
  const size_t count = std::min(kNeighbours, nearest.size());
  std::partial_sort(nearest.begin(), nearest.begin() + static_cast<ptrdiff_t>(count), nearest.end());
  double weights = 0.0, sum = 0.0, squares = 0.0;
  for (size_t i = 0; i < count; ++i) {
    const double weight = 1.0 / (nearest[i].first + kSoftening_rad * kSoftening_rad);
    weights += weight;
    sum += weight * nearest[i].second;
    squares += weight * nearest[i].second * nearest[i].second;
  }
  const double mean = sum / weights;
  expected.distance_m = 1.0 / mean;
  const double spread = std::sqrt(std::max(0.0, squares / weights - mean * mean)) / mean;
  if (count == kNeighbours && nearest[count - 1].first < kAround_rad * kAround_rad && spread < kMostSpread)
    expected.relative_sigma = std::hypot(kBend, spread);
  return expected;
}

}  // namespace lodeline
