#pragma once

#include "lodeline/evaluation/read_trajectory.h"
#include "lodeline/evaluation/text_table.h"

/// The readers behind readTrajectory, one layout each. They return the poses in the order of the file.
namespace lodeline {

Trajectory readTum(const std::filesystem::path& path, Diagnostics& diagnostics);
Trajectory readKitti(const std::filesystem::path& path, Diagnostics& diagnostics);
Trajectory readEuroc(const std::filesystem::path& path, Diagnostics& diagnostics);
Trajectory readColmapText(const std::filesystem::path& path, const TrajectoryReadOptions& options,
                          Diagnostics& diagnostics);
Trajectory readColmapBinary(const std::filesystem::path& path, const TrajectoryReadOptions& options,
                            Diagnostics& diagnostics);

/// Removes the last line, with a warning, when it has fewer columns than needed and no line end: it was cut
/// off while being written. Throws InputError when another line has fewer.
void requireColumns(TextTable& table, std::size_t columns, const char* layout, Diagnostics& diagnostics);

/// Position and quaternion of a line as a pose, the quaternion normalised. Nothing, with a warning, when a
/// value is NaN or infinite; InputError when the quaternion's norm is more than 5 % off one.
std::optional<Rigid3> poseFromNumbers(const std::string& where, const Vec3& position_m, const Quat& rotation,
                                      Diagnostics& diagnostics);

}  // namespace lodeline
