#pragma once

#include <filesystem>

#include "lodeline/evaluation/trajectory/trajectory.h"

namespace lodeline {

/// Writes a trajectory in the TUM layout, time stamps exact to 1 ns. Throws InputError where that fails.
void writeTum(const Trajectory& trajectory, const std::filesystem::path& file);

}  // namespace lodeline
