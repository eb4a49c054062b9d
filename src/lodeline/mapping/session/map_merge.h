#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/mapping/session/dive_mapping.h"
#include "lodeline/mapping/store/map_file.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {

struct MapMergeOptions {
  MappingOptions mapping;
  /// Features of a keyframe are left out where an earlier keyframe of the map or of the dive sees the same:
  /// nearer than this, m, and turned by less than `redundant_turn_rad`. These are half of the limits within
  /// which candidates for loops are looked for. So what would find the keyframe finds the earlier one. The
  /// map then grows with the passage, not with the number of visits.
  double redundant_distance_m = 0.75;
  double redundant_turn_rad = 0.35;
  /// Takes the share of the run's keyframes that have been looked for.
  ShareDone progress = [](double) {};
};

struct MergedDive {
  std::string name;
  MappingSummary summary;
  std::vector<Loop> ledger;
  int without_features = 0;  ///< keyframes that add nothing to what earlier ones see
};

/// Adds the dive of a run to a common map: looks for its places in the map, keyframe by keyframe, and writes
/// dive and ledger in one transaction. `run`: the run's map.db. The map must be solved afterwards
/// (solveMap()). Throws InputError where a dive of that name is in the map.
MergedDive mergeDive(MapFile* map, const MapFile& run, const MapMergeOptions& options);

}  // namespace lodeline
