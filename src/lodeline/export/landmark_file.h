#pragma once

#include <filesystem>
#include <vector>

#include "lodeline/geometry/types.h"

namespace lodeline {

/// A point of a map, in the world of the map's trajectory.
struct MapLandmark {
  Vec3 position = Vec3::Zero();  ///< m
  int sightings = 0;
};

/// Reads `landmarks.ply` as `lodeline run` writes it. Throws InputError where it has another layout or is cut
/// off; points that are not finite are left out.
std::vector<MapLandmark> readLandmarkFile(const std::filesystem::path& file);

}  // namespace lodeline
