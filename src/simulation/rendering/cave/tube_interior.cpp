#include "simulation/rendering/cave/tube_interior.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace lodeline {

TubeInterior::TubeInterior(const CaveWalls& walls) : walls_(walls) {
  const auto& rings = walls.rings;
  spacing_m_ = std::max(0.01f, (rings[1].center - rings[0].center).norm());
  coarse_step_ = std::max(1, static_cast<int>(0.5f / spacing_m_));
  for (size_t i = 0; i < rings.size(); ++i) {
    for (int j = 0; j < walls.ring_size; ++j)
      reach_m_ = std::max(reach_m_, (walls.vertex(static_cast<int>(i), j) - rings[i].center).norm());
  }
}

int TubeInterior::ringAt(const Vec3f& point) const {
  const auto& rings = walls_.rings;
  const int count = static_cast<int>(rings.size());
  int nearest = 0;
  float least = std::numeric_limits<float>::infinity();
  for (int i = 0; i < count; i += coarse_step_) {
    const float squared = (rings[i].center - point).squaredNorm();
    if (squared < least) {
      least = squared;
      nearest = i;
    }
  }
  if (std::sqrt(least) > reach_m_ + 2.0f) return -1;
  for (int step = 0; step < 8; ++step) {
    const float along_m = rings[nearest].forward.dot(point - rings[nearest].center);
    const int moved = nearest + static_cast<int>(std::lround(along_m / spacing_m_));
    const int next = walls_.closed ? (moved % count + count) % count : std::clamp(moved, 0, count - 1);
    if (next == nearest) break;
    nearest = next;
  }
  const float off_m = std::abs(rings[nearest].forward.dot(point - rings[nearest].center));
  return off_m > 2.0f * spacing_m_ ? -1 : nearest;
}

bool TubeInterior::contains(const Vec3f& point, float margin_m) const {
  const int i = ringAt(point);
  if (i < 0) return false;
  const WallRing& ring = walls_.rings[i];
  const Vec3f offset = point - ring.center;
  const float x = offset.dot(ring.right), y = offset.dot(ring.up);
  const float turns = std::atan2(y, x) / (2.0f * std::numbers::pi_v<float>);
  const float place = (turns - std::floor(turns)) * static_cast<float>(walls_.ring_size);
  const int j = static_cast<int>(place) % walls_.ring_size;
  const float share = place - std::floor(place);
  const float wall_m = (1.0f - share) * (walls_.vertex(i, j) - ring.center).norm() +
                       share * (walls_.vertex(i, (j + 1) % walls_.ring_size) - ring.center).norm();
  return std::hypot(x, y) + margin_m < wall_m;
}

void removeInside(const TubeInterior& other, float margin_m, TriangleMesh* mesh) {
  std::vector<char> inside(mesh->positions.size());
  tbb::parallel_for(size_t{0}, mesh->positions.size(),
                    [&](size_t i) { inside[i] = other.contains(mesh->positions[i], margin_m) ? 1 : 0; });
  std::erase_if(mesh->triangles, [&](const std::array<uint32_t, 3>& t) {
    return inside[t[0]] != 0 && inside[t[1]] != 0 && inside[t[2]] != 0;
  });
}

}  // namespace lodeline
