#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline map`: maps of many dives.
void addMapCommand(CLI::App& program);

}  // namespace lodeline
