#include "lodeline/magnetometer/field_map/field_map.h"

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

// Half sizes in length scales.
constexpr double kCube = 1.25, kMargin = 2.0, kBox = 3.0;

}  // namespace

FieldMap::FieldMap(const FieldMapOptions& options)
    : options_(options),
      basis_(kBox * options.length_scale_m, options.length_scale_m, options.field_sigma_T) {}

FieldMap::Cell FieldMap::cellOf(const Vec3& place) const {
  const double size_m = 2.0 * kCube * options_.length_scale_m;
  Cell cell;
  for (int d = 0; d < 3; ++d) cell[static_cast<size_t>(d)] = static_cast<int>(std::lround(place[d] / size_m));
  return cell;
}

Vec3 FieldMap::centreOf(const Cell& cell) const {
  return 2.0 * kCube * options_.length_scale_m * Vec3(cell[0], cell[1], cell[2]);
}

template <typename Act>
void FieldMap::forCellsAround(const Vec3& place, const Act& act) const {
  const double reach_m = kMargin * options_.length_scale_m;
  const Cell here = cellOf(place);
  for (int x = here[0] - 1; x <= here[0] + 1; ++x) {
    for (int y = here[1] - 1; y <= here[1] + 1; ++y) {
      for (int z = here[2] - 1; z <= here[2] + 1; ++z) {
        const Cell cell{x, y, z};
        if ((place - centreOf(cell)).cwiseAbs().maxCoeff() <= reach_m) act(cell);
      }
    }
  }
}

void FieldMap::makeRoom() {
  if (tiles() < options_.max_tiles) return;
  tiles_.erase(std::min_element(tiles_.begin(), tiles_.end(), [](const auto& a, const auto& b) {
    return a.second.last_visit < b.second.last_visit;
  }));
}

void FieldMap::learn(const Vec3& place, const Vec3& anomaly, const Mat3& covariance,
                     const FieldMapOrigin& origin) {
  if (!place.allFinite() || !anomaly.allFinite() || !covariance.allFinite()) return;
  ++visits_;
  forCellsAround(place, [&](const Cell& cell) {
    auto found = tiles_.find(cell);
    if (found == tiles_.end()) {
      makeRoom();
      found = tiles_.emplace(cell, Entry{FieldMapTile(basis_, centreOf(cell)), 0, 0.0, 0.0, Time(), 0}).first;
    }
    Entry& entry = found->second;
    const double variance_T2 = entry.tile.predict(place).covariance.trace() / 3.0;
    if (variance_T2 < options_.known_sigma_T * options_.known_sigma_T) return;
    entry.tile.add(place, anomaly, covariance);
    ++entry.readings;
    entry.heading_variance_sum += origin.heading_variance_rad2;
    entry.position_variance_sum += origin.position_variance_m2;
    entry.last_reading = origin.time;
    entry.last_visit = visits_;
  });
}

std::optional<FieldMapPrediction> FieldMap::predict(const Vec3& place) {
  if (!place.allFinite()) return {};
  const auto found = tiles_.find(cellOf(place));
  if (found == tiles_.end()) return {};
  Entry& entry = found->second;
  entry.last_visit = ++visits_;
  return FieldMapPrediction{entry.tile.predict(place), entry.heading_variance_sum / entry.readings,
                            entry.position_variance_sum / entry.readings, entry.last_reading};
}

void FieldMap::forget(const Vec3& place) {
  forCellsAround(place, [&](const Cell& cell) { tiles_.erase(cell); });
}

}  // namespace lodeline
