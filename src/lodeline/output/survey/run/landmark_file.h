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

/// Reads `landmarks.ply` as `lodeline run` writes it; points that are not finite are left out. Of a run that
/// was killed, whose file has no count yet, no end or not even a header, gives the whole points that are
/// there, and reports it. Throws InputError where the file has another layout.
std::vector<MapLandmark> readLandmarkFile(const std::filesystem::path& file, Diagnostics* diagnostics);

}  // namespace lodeline
