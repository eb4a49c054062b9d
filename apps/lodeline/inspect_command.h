#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline inspect DATA`: faults of a recording.
void addInspectCommand(CLI::App& program);

}  // namespace lodeline
