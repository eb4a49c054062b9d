#pragma once

#include <ros/node_handle.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lodeline/io/synchronizer/live_source.h"
#include "lodeline/pipeline/run_request.h"
#include "lodeline_ros/conversions.h"

namespace lodeline {

/// What the node is told by its private parameters (docs/ros.md lists them).
struct NodeParameters {
  std::vector<std::filesystem::path> rig_files;
  std::map<std::string, std::string> topics;  ///< by sensor, over what the rig files say
  RunRequest run;                             ///< folder of results, settings, magnetometer
  FrameNames frames;
  LiveSourceOptions source;
  bool publish_tf = true;
  bool report = true;  ///< write report.html at the end
};

/// Throws UsageError for a parameter that is missing, unknown (naming the nearest known one) or of the wrong
/// type. `node`: of the private name space.
NodeParameters readNodeParameters(const ros::NodeHandle& node);

}  // namespace lodeline
