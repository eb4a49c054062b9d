#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

namespace lodeline {

/// Adds `lodeline settings`, which prints the settings of a run with their meaning and value.
void addSettingsCommand(CLI::App& program);

}  // namespace lodeline
