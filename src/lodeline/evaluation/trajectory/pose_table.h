#pragma once

#include <memory>
#include <optional>
#include <string>

#include "lodeline/evaluation/trajectory/read_trajectory.h"
#include "lodeline/io/tables/byte_source.h"

namespace lodeline {

/// Reads a table of poses, a row each, in the order of the file.
///
/// A header that names the columns decides (findPoseColumns, findTimeColumns). Without one the first row's
/// number of columns and the numbers themselves do: 12 or 16 numbers that are a 3x4 or 4x4 matrix (KITTI),
/// the same behind a time, else a time, a position and a quaternion. Of the quaternion w stands first behind
/// stamps in nanoseconds with commas (EuRoC, VINS-Fusion), else last (TUM, ORB-SLAM3). `format` Tum, Kitti or
/// Euroc fixes the order of the columns, whatever the header says.
///
/// Times are in the unit that the header states, else in the one that their size as Unix time says, else in
/// seconds, unless only another unit gives a plausible rate. What is assumed and not usual is reported.
///
/// Throws InputError, with file and line, for a row with another number of columns than the first, for a
/// number that is none, and for rotations that are none. Poses with NaN and a last line that was cut off are
/// passed over with a warning.
Trajectory readPoseTable(std::unique_ptr<ByteSource> bytes, const std::string& name,
                         std::optional<TrajectoryFormat> format, Diagnostics& diagnostics);

}  // namespace lodeline
