#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline refine DATA -o OUT`: a run, followed by the batch solution of all its measurements. Its callback
/// throws like that of `lodeline run`.
void addRefineCommand(CLI::App& program);

}  // namespace lodeline
