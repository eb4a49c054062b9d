#pragma once

#include "lodeline/evaluation/trajectory/read_trajectory.h"
#include "lodeline/evaluation/trajectory/text_table.h"

/// The readers behind readTrajectory, one layout each. They return the poses in the order of the file.
namespace lodeline {

Trajectory readColmapText(const std::filesystem::path& path, const TrajectoryReadOptions& options,
                          Diagnostics& diagnostics);
Trajectory readColmapBinary(const std::filesystem::path& path, const TrajectoryReadOptions& options,
                            Diagnostics& diagnostics);

/// Position and quaternion of a line as a pose, the quaternion normalized. Nothing, with a warning, when a
/// value is NaN or infinite; InputError when the quaternion's norm is more than 5 % off one.
std::optional<Rigid3> poseFromNumbers(const std::string& where, const Vec3& position_m, const Quat& rotation,
                                      Diagnostics& diagnostics);

}  // namespace lodeline
