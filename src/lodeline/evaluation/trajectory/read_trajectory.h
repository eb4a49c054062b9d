#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lodeline/evaluation/trajectory/trajectory.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Layouts of trajectories that can be read.
enum class TrajectoryFormat {
  Table,         ///< columns by their header, or by their position (readPoseTable)
  Tum,           ///< `t x y z qx qy qz qw`, further columns ignored
  Kitti,         ///< 12 numbers per line: the upper 3x4 part of world_from_camera, row by row; no times
  Euroc,         ///< `t, x, y, z, qw, qx, qy, qz, ...`, the EuRoC ground truth
  ColmapText,    ///< COLMAP images.txt
  ColmapBinary,  ///< COLMAP images.bin
};

/// "table", "tum", "kitti", "euroc", "colmap-text", "colmap-binary" and back; UsageError for another name.
const char* toString(TrajectoryFormat format);
TrajectoryFormat trajectoryFormatFromString(const std::string& name);

struct TrajectoryReadOptions {
  std::optional<TrajectoryFormat> format;  ///< detected from the file when absent

  /// Times of COLMAP images: lines `name time[s]` or EuRoC's `time[ns],name`. Without it the file names must
  /// be times (nanoseconds, or seconds with a decimal point).
  std::optional<std::filesystem::path> image_times;

  /// Transformation of COLMAP's camera poses to body poses.
  std::optional<Rigid3> body_from_camera;
};

/// The file that contains the poses, and its layout.
struct TrajectorySource {
  std::filesystem::path file;
  TrajectoryFormat format;
};

/// Finds the poses: a file in one of the layouts (text may be compressed with gzip), a folder written by
/// `lodeline run` (`trajectory.tum`), a EuRoC recording, its `mav0` or its `state_groundtruth_estimate0`, or
/// a COLMAP model folder. Throws InputError, with the expected files, when nothing fits.
TrajectorySource findTrajectory(const std::filesystem::path& path,
                                std::optional<TrajectoryFormat> format = std::nullopt);

/// Reads a trajectory and orders it by time. Tables may be in UTF-8, UTF-16 or Latin-1, with any line ends
/// and separators (TableReader). A line that does not fit its layout, a quaternion that is not a rotation and
/// a file without poses throw InputError with file and line. Poses with NaN ("lost" in some references) and
/// an incomplete last line are skipped with a warning.
Trajectory readTrajectory(const std::filesystem::path& path, const TrajectoryReadOptions& options,
                          Diagnostics& diagnostics);

}  // namespace lodeline
