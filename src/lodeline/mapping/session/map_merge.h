#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/mapping/session/dive_mapping.h"
#include "lodeline/mapping/store/map_file.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {

/// Where a dive began, as stated: east, north, up relative to the origin of the map, m.
struct DiveStart {
  Vec3 position = Vec3::Zero();
  double horizontal_sigma_m = 3.0;  ///< per axis, as of a GPS fix of the entrance
  double vertical_sigma_m = 1.0;
};

struct MapMergeOptions {
  MappingOptions mapping;
  std::optional<DiveStart> start;
  /// Features of a keyframe are left out where the map has a keyframe that sees the same: nearer than this,
  /// m, and turned by less than `redundant_turn_rad`. The map then grows with the cave, not with the dives.
  double redundant_distance_m = 0.5;
  double redundant_turn_rad = 0.26;
  /// Takes the share of the run's keyframes that have been looked for.
  ShareDone progress = [](double) {};
};

struct MergedDive {
  std::string name;
  MappingSummary summary;
  std::vector<Loop> ledger;
  int without_features = 0;  ///< keyframes that add nothing to what the map sees
};

/// Adds the dive of a run to a common map: looks for its places in the map, keyframe by keyframe, and writes
/// dive and ledger in one transaction. `run`: the run's map.db. The map must be solved afterwards
/// (solveMap()). Throws InputError where a dive of that name is in the map.
MergedDive mergeDive(MapFile* map, const MapFile& run, const MapMergeOptions& options);

}  // namespace lodeline
