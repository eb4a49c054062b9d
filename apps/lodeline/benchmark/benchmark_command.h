#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline benchmark SET FOLDER`: runs every sequence of a public set and compares the errors with
/// published ones. Its callback throws as that of `lodeline batch` does.
void addBenchmarkCommand(CLI::App& program);

}  // namespace lodeline
