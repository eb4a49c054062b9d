#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lodeline/mapping/store/map_file.h"

namespace lodeline::test {

/// A map of three dives of one cave with a loop, a junction and two entrances, solved, and the truth. Dive
/// "upstream" swims the main passage from entrance A and back. "loop" takes a side passage that leaves the
/// main one and comes back to it. "sink" comes from entrance B to the main passage. Odometry drifts; every
/// few metres, a place that was seen before makes a loop.
struct CaveMap {
  /// Writes the map. `seed`: of all errors.
  CaveMap(const std::filesystem::path& file, unsigned seed);

  /// True position by stamp, east, north, up of the first pose of the first dive, m.
  std::map<int64_t, Vec3> truth;
  double passages_m = 0.0;               ///< length of all passages
  std::vector<std::string> unconnected;  ///< dives that the solution does not join
  Vec3 entrance_B = Vec3::Zero();
};

}  // namespace lodeline::test
