#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// Adds `lodeline survey`: several dives as one cave for Survex and Therion.
void addSurveyCommand(CLI::App& program);

}  // namespace lodeline
