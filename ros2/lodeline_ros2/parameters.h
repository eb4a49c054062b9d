#pragma once

#include <rclcpp/node.hpp>

#include "lodeline/node/node_option.h"

namespace lodeline {

/// Declares the options of a run on live topics as parameters and reads them. `topics` and `qos` may also be
/// given by sensor, as `topics.cam0`. Parameters that the node does not know are passed on, so that the
/// session refuses them. Throws std::runtime_error for a parameter of a type that no option has.
OptionValues readParameters(rclcpp::Node* node);

}  // namespace lodeline
