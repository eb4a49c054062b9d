#pragma once

#include <ros/node_handle.h>

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/synchronizer/live_source.h"
#include "lodeline_ros/raw_message.h"

namespace lodeline {

/// Topics by sensor (cam0, imu0, mag0, pressure0): what `named` says, else the rig file. Throws InputError
/// where a camera of `rig` or the IMU has none, and UsageError for a sensor that the rig does not have. Takes
/// a magnetometer or pressure sensor without a topic out of the rig.
std::map<std::string, std::string> chooseLiveTopics(const RigFile& rig_file,
                                                    const std::map<std::string, std::string>& named,
                                                    Rig* rig);

/// Subscribes to the sensors' topics and pushes what comes into a source. Callbacks only copy and parse;
/// images are decoded by whoever pulls them. Messages of a wrong type, cut off or without finite numbers are
/// passed over with a warning in ROS's log.
class SensorIntake {
 public:
  /// `source` must outlive the intake. `water`: how pressure becomes depth.
  SensorIntake(ros::NodeHandle node, const std::map<std::string, std::string>& topics,
               const WaterColumn& water, LiveSource* source);

 private:
  using Event = ros::MessageEvent<const RawMessage>;
  /// Parses a message and pushes it; throws or sets `problem` where it cannot.
  using Push = std::function<void(const Event& event, std::string* problem)>;

  void subscribe(const std::string& sensor, const std::string& topic, uint32_t queue_size, const Push& push);
  Push pushFor(const std::string& sensor, const std::string& topic, const WaterColumn& water);

  ros::NodeHandle node_;
  LiveSource* source_;
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace lodeline
