#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline inspect DATA`: what is wrong with a recording.
void addInspectCommand(CLI::App& program);

}  // namespace lodeline
