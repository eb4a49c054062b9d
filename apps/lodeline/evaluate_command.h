#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline evaluate ESTIMATE REFERENCE`: errors of a trajectory. Its callback throws InputError and
/// UsageError.
void addEvaluateCommand(CLI::App& program);

}  // namespace lodeline
