#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/export/write_formats.h"

namespace lodeline {

enum class MapFormat { Survex, Therion, GeoJson, Kml, Gpx, Ply, Csv, Tum, Colmap };
/// In the order of MapFormat.
const std::vector<std::string>& mapFormatNames();
/// Throws UsageError, naming the formats that there are.
MapFormat mapFormatFromString(const std::string& name);

/// Cameras and images of the recording, which only COLMAP wants.
struct MapImages {
  std::vector<CameraCalibration> cameras;
  std::vector<ColmapImage> images;
};

/// Writes a map in one format into a folder that exists, and gives the files. Throws UsageError where the
/// format needs a place, or images, that the map does not have, and InputError where a file cannot be
/// written.
std::vector<std::filesystem::path> writeMap(const DiveMap& map, const std::optional<MapImages>& images,
                                            MapFormat format, const std::filesystem::path& folder);

}  // namespace lodeline
