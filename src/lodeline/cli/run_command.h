#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline run DATA -o OUT`: from a recording to a trajectory, its uncertainty and a map. Its callback
/// throws InputError, UsageError and EstimationError.
void addRunCommand(CLI::App& program);

}  // namespace lodeline
