#pragma once

#include <ros/node_handle.h>

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/recording.h"
#include "lodeline_ros/raw_message.h"

namespace lodeline {

/// Topics by sensor (cam0, imu0, mag0, pressure0): from `named`, otherwise from the rig file. Throws
/// InputError where a camera of `rig` or the IMU has none, and UsageError for a sensor that the rig does not
/// have. Removes a magnetometer or pressure sensor without a topic from the rig.
std::map<std::string, std::string> chooseLiveTopics(const RigFile& rig_file,
                                                    const std::map<std::string, std::string>& named,
                                                    Rig* rig);

/// Subscribes to the sensors' topics and pushes their messages into a source. Callbacks only copy and parse;
/// the thread that pulls images decodes them. Messages that have a wrong type, are truncated or have
/// non-finite numbers are ignored with a warning in ROS's log.
class SensorIntake {
 public:
  /// `source` must outlive the intake. `water`: parameters that convert pressure to depth.
  SensorIntake(ros::NodeHandle node, const std::map<std::string, std::string>& topics,
               const WaterColumn& water, LiveSource* source);

 private:
  using Event = ros::MessageEvent<const RawMessage>;
  /// Parses a message and pushes it; on failure, throws or sets `problem`.
  using Push = std::function<void(const Event& event, std::string* problem)>;

  void subscribe(const std::string& sensor, const std::string& topic, uint32_t queue_size, const Push& push);
  Push pushFor(const std::string& sensor, const std::string& topic, const WaterColumn& water);

  ros::NodeHandle node_;
  LiveSource* source_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace lodeline
