#pragma once

#include <filesystem>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/formats/map_files.h"

namespace lodeline {

/// Writes the database of a map's cameras and images, with poses as priors, for COLMAP's extraction, matching
/// and reconstruction. Numbers of cameras and images are those of colmapModel(). Replaces the file. A camera
/// whose model COLMAP lacks is reported as `colmap_camera_fitted`. Throws UsageError without images, and
/// InputError where the file cannot be written.
///
/// The schema is that of COLMAP 3.8 (src/base/database.cc), and the table pose_priors that of COLMAP 3.11
/// (src/colmap/scene/database.cc). The rotation of a prior is camera_from_map. Its translation is the centre
/// of the camera in the map, m, as COLMAP's spatial matcher expects.
void writeColmapDatabase(const DiveMap& map, const std::optional<MapImages>& images,
                         const std::filesystem::path& file, Diagnostics* diagnostics);

}  // namespace lodeline
