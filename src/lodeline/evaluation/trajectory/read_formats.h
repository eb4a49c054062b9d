#pragma once

#include "lodeline/evaluation/trajectory/text_table.h"
#include "lodeline/trajectory.h"

/// Readers of readTrajectory(), one per layout. They return the poses in the order of the file.
namespace lodeline {

Trajectory readColmapText(const std::filesystem::path& path, const TrajectoryReadOptions& options,
                          Diagnostics& diagnostics);
Trajectory readColmapBinary(const std::filesystem::path& path, const TrajectoryReadOptions& options,
                            Diagnostics& diagnostics);

/// Position and quaternion of a line as a pose, the quaternion normalized. Empty, with a warning, when a
/// value is NaN or infinite. Throws InputError when the quaternion's norm differs from one by more than 5 %.
std::optional<Rigid3> poseFromNumbers(const std::string& where, const Vec3& position_m, const Quat& rotation,
                                      Diagnostics& diagnostics);

}  // namespace lodeline
