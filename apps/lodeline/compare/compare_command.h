#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline compare DATA|SCENARIO... -o OUT`: methods against each other on recordings with ground truth.
/// Its callback throws InputError, UsageError and EstimationError.
void addCompareCommand(CLI::App& program);

}  // namespace lodeline
