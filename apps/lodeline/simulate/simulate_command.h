#pragma once

#include <CLI/App.hpp>

#include "lodeline/simulation.h"

namespace lodeline {

/// `lodeline simulate SCENARIO -o DIR`: a recording of a simulated dive with exact ground truth. Its callback
/// throws InputError and UsageError.
void addSimulateCommand(CLI::App& program);

/// Options that change a scenario, except for the number of cameras and the omission of images.
void addScenarioOptions(CLI::App* command, ScenarioChanges* changes);

}  // namespace lodeline
