#pragma once

#include <string>
#include <vector>

#include "lodeline/node/messages/estimate_messages.h"
#include "lodeline/node/node_option.h"
#include "lodeline/pipeline/run_request.h"
#include "lodeline/recording.h"

namespace lodeline {

/// Quality of service with which a topic is received.
struct SensorQos {
  bool is_reliable = false;
  int depth = 0;  ///< most messages that wait; 0 for the default of the kind of sensor
};

/// The values of nodeOptions().
struct NodeSettings {
  std::vector<std::string> rig_files;
  std::vector<std::string> topics;  ///< SENSOR=TOPIC, with priority over the rig files
  std::vector<std::string> qos;     ///< SENSOR=RELIABILITY[:DEPTH]
  RunRequest run;                   ///< results folder, settings, magnetometer
  FrameNames frames;
  LiveSourceOptions source;
  bool publish_tf = true;
  bool report = true;  ///< write report.html at the end

  std::map<std::string, std::string> topicsBySensor() const;
  /// The last entry of `qos` that names the sensor or `all`.
  SensorQos qosOf(const std::string& sensor) const;
};

/// Throws UsageError for an option that is missing, unknown (naming the nearest known one), of the wrong type
/// or out of range.
NodeSettings readNodeSettings(const OptionValues& values);

}  // namespace lodeline
