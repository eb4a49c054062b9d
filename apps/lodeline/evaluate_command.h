#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline evaluate ESTIMATE REFERENCE`: how good a trajectory is. Its callback throws InputError and
/// UsageError.
void addEvaluateCommand(CLI::App& program);

}  // namespace lodeline
