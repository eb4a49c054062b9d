#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline convert SRC DST`: a ROS 1 bag from an EuRoC folder, and the other way.
void addConvertCommand(CLI::App& program);

}  // namespace lodeline
