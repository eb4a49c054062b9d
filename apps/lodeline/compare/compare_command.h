#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline compare DATA|SCENARIO... -o OUT`: comparison of methods on recordings with ground truth. Its
/// callback throws InputError, UsageError and EstimationError.
void addCompareCommand(CLI::App& program);

}  // namespace lodeline
