#include "lodeline/mapping/session/map_points.h"

#include <map>

namespace lodeline {

std::vector<MapLandmark> mapPointsOf(const MapFile& map, DiveId dive) {
  struct Known {
    MapLandmark landmark;
    double sigma_m = 0.0;
  };
  std::map<TrackId, Known> known;
  std::vector<StoredKeyframe> rows;
  map.forEachKeyframe(dive, [&](const StoredKeyframe& row) {
    if (row.solved && row.feature_count > 0) rows.push_back(row);
  });
  for (const StoredKeyframe& row : rows) {
    for (const MapFeature& feature : map.features(row.keyframe.id)) {
      if (feature.track < 0 || !feature.point_B) continue;
      const auto [entry, is_new] = known.try_emplace(feature.track);
      Known& point = entry->second;
      ++point.landmark.observations;
      if (!is_new && point.sigma_m <= feature.distance_sigma_m) continue;
      point.landmark.position = row.solved->map_from_body * *feature.point_B;
      point.sigma_m = feature.distance_sigma_m;
    }
  }
  std::vector<MapLandmark> points;
  for (const auto& [track, point] : known) points.push_back(point.landmark);
  return points;
}

}  // namespace lodeline
