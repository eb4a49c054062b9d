#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline calibrate magnetometer DATA -o mag.yaml`. Its callback throws InputError, UsageError and
/// EstimationError.
void addCalibrateCommand(CLI::App& program);

}  // namespace lodeline
