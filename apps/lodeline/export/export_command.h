#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline export`: a run as survey and map files.
void addExportCommand(CLI::App& program);

}  // namespace lodeline
