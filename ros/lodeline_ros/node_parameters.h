#pragma once

#include <ros/node_handle.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lodeline/pipeline/run_request.h"
#include "lodeline/recording.h"
#include "lodeline_ros/conversions.h"

namespace lodeline {

/// Private parameters of the node (docs/reference/ros-node.md lists them).
struct NodeParameters {
  std::vector<std::filesystem::path> rig_files;
  std::map<std::string, std::string> topics;  ///< by sensor, with priority over the rig files
  RunRequest run;                             ///< results folder, settings, magnetometer
  FrameNames frames;
  LiveSourceOptions source;
  bool publish_tf = true;
  bool report = true;  ///< write report.html at the end
};

/// Reads the parameters. Throws UsageError for a parameter that is missing, unknown (naming the nearest known
/// one) or of the wrong type. `node`: handle of the private namespace.
NodeParameters readNodeParameters(const ros::NodeHandle& node);

}  // namespace lodeline
