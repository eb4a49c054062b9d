#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline attitude`: orientation and heading without images.
void addAttitudeCommand(CLI::App& program);

}  // namespace lodeline
