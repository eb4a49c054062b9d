#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline simulate SCENARIO -o DIR`: a recording of a simulated dive with exact truth. Its callback throws
/// InputError and UsageError.
void addSimulateCommand(CLI::App& program);

}  // namespace lodeline
