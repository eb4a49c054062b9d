#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// Adds `lodeline map build`, `map add` and `map solve`: many dives in one map.
void addMapBuildCommands(CLI::App* map);

/// Adds `lodeline map info`, `map check` and `map remove`.
void addMapContentCommands(CLI::App* map);

/// Adds `lodeline map control`: known positions of stations, fixes and marks.
void addMapControlCommand(CLI::App* map);

/// Adds `lodeline map relocalise`: the place of short clips of a dive in a map.
void addMapRelocaliseCommand(CLI::App* map);

/// Adds `lodeline map export`: one survey of all dives of a map.
void addMapExportCommand(CLI::App* map);

}  // namespace lodeline
