#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline refine DATA -o OUT`: a run, and then the solution of all its measurements at once. Its callback
/// throws as that of `lodeline run`.
void addRefineCommand(CLI::App& program);

}  // namespace lodeline
