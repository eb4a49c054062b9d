#pragma once

#include <ros/node_handle.h>

#include "lodeline/node/node_option.h"

namespace lodeline {

/// Reads the private parameters of the node (docs/reference/ros-node.md lists them): the options of a run on
/// live topics. Throws UsageError for a parameter that is unknown (naming the nearest known one) or of the
/// wrong type. `node`: handle of the private namespace.
OptionValues readNodeParameters(const ros::NodeHandle& node);

}  // namespace lodeline
