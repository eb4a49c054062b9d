#pragma once

#include <filesystem>
#include <memory>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/container/bag_file.h"

namespace lodeline {

/// Opens a ROS 1 bag, a ROS 2 bag in SQLite (.db3) or MCAP, or the folder of a ROS 2 bag. The first bytes
/// decide, not the name. Throws InputError like Ros1Bag and Ros2Bag. `diagnostics` must outlive the bag.
std::unique_ptr<BagFile> openBagFile(const std::filesystem::path& bag, Diagnostics* diagnostics);

}  // namespace lodeline
