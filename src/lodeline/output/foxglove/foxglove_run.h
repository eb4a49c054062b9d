#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/estimate.h"
#include "lodeline/output/files/run_table.h"
#include "lodeline/trajectory.h"

namespace lodeline::foxglove {

/// A finding as run.json has it.
struct StoredFinding {
  std::string severity, kind, message;
};

/// A picture of the run folder, named by its stamp.
struct StoredPicture {
  Time time;
  std::filesystem::path file;
};

/// What a run folder has to show.
struct Run {
  std::string program;  ///< "lodeline 0.1.0"
  std::vector<StampedPose> odom_from_body;
  std::vector<StampedPose> map_from_body;      ///< empty without trajectory_map.tum or a pose in it
  std::vector<StampedPose> refined_from_body;  ///< empty without trajectory_refined.tum
  std::vector<MapLandmark> landmarks;          ///< in odom
  std::optional<RunTable> states;
  std::vector<StoredFinding> findings;
  std::vector<StoredPicture> pictures;  ///< in the order of time; only those within the run
};

/// Reads the folder of `lodeline run`. Only trajectory.tum is necessary. Missing files that every run has are
/// reported. Throws InputError naming the file where one is malformed, and for stamps before 1970.
Run readRun(const std::filesystem::path& folder, bool with_pictures, Diagnostics* diagnostics);

}  // namespace lodeline::foxglove
