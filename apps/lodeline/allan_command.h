#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline allan`: noise of the sensors from a record at rest.
void addAllanCommand(CLI::App& program);

}  // namespace lodeline
