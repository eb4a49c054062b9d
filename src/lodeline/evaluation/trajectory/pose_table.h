#pragma once

#include <memory>
#include <optional>
#include <string>

#include "lodeline/io/tables/byte_source.h"
#include "lodeline/trajectory.h"

namespace lodeline {

/// Reads a table of poses, one per row, in the order of the file.
///
/// A header that names the columns determines them (findPoseColumns, findTimeColumns). Without a header they
/// follow from the first row's number of columns and the numbers themselves: 12 or 16 numbers that are a 3x4
/// or 4x4 matrix (KITTI), the same after a time, else a time, a position and a quaternion. In the quaternion,
/// w comes first after stamps in nanoseconds with commas (EuRoC, VINS-Fusion), else last (TUM, ORB-SLAM3).
/// `format` Tum, Kitti or Euroc fixes the order of the columns, whatever the header states.
///
/// Times are in the unit of the header, else in the one that fits Unix time, else in seconds. Another unit
/// counts where it alone gives a plausible rate. Unusual assumptions are reported.
///
/// Throws InputError, with file and line, for a row of another length, for text that is not a number, and for
/// invalid rotations. Poses with NaN and an incomplete last line are skipped with a warning.
Trajectory readPoseTable(std::unique_ptr<ByteSource> bytes, const std::string& name,
                         std::optional<TrajectoryFormat> format, Diagnostics& diagnostics);

}  // namespace lodeline
