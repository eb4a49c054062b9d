#pragma once

#include <filesystem>
#include <vector>

#include "lodeline/geometry/types.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// A point of a map, in the world of the map's trajectory.
struct MapLandmark {
  Vec3 position = Vec3::Zero();  ///< m
  int observations = 0;
};

/// Reads `landmarks.ply` of `lodeline run`; points that are not finite are skipped. The file of a killed run
/// may have no count, no end or no header. Its complete points are returned, and the problem is reported.
/// Throws InputError where the file has another layout.
std::vector<MapLandmark> readLandmarkFile(const std::filesystem::path& file, Diagnostics* diagnostics);

}  // namespace lodeline
