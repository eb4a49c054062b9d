#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/output/survey/formats/write_formats.h"
#include "lodeline/survey.h"

namespace lodeline {

/// In the order of MapFormat.
const std::vector<std::string>& mapFormatNames();
/// Format by its name in any case. Throws UsageError with the names of all formats.
MapFormat mapFormatFromString(const std::string& name);

/// Cameras and images of the recording, needed only for COLMAP.
struct MapImages {
  std::vector<CameraCalibration> cameras;
  std::vector<ColmapImage> images;
};

/// Names of the files of one format for a survey of that name.
std::vector<std::string> mapFileNames(const std::string& name, MapFormat format);

/// Writes a map in one format into an existing folder, and returns the files. Throws UsageError where the
/// format needs a position, or images, that the map does not have, and InputError where a file cannot be
/// written.
std::vector<std::filesystem::path> writeMap(const DiveMap& map, const std::optional<MapImages>& images,
                                            MapFormat format, const std::filesystem::path& folder);

/// Whether a format can join several dives in one project.
bool joinsDives(MapFormat format);
/// Writes the file that joins several dives, whose own files are in the same folder.
std::vector<std::filesystem::path> writeProject(const std::vector<DiveMap>& maps, const std::string& name,
                                                const std::string& title, MapFormat format,
                                                const std::filesystem::path& folder);

}  // namespace lodeline
