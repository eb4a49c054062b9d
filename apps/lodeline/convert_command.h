#pragma once

#include <CLI/App.hpp>

namespace lodeline {

/// `lodeline convert SRC DST`: converts between EuRoC folders, ROS 1 bags and ROS 2 bags.
void addConvertCommand(CLI::App& program);

}  // namespace lodeline
