#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline convert SRC DST`: converts an EuRoC folder to a ROS 1 bag, or a bag to a folder.
void addConvertCommand(CLI::App& program);

}  // namespace lodeline
