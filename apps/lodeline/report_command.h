#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline report`: one page from the output folders of runs.
void addReportCommand(CLI::App& program);

}  // namespace lodeline
