#pragma once

#include <map>
#include <string>
#include <vector>

#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/rosbag/messages.h"

namespace lodeline {

/// Topics by sensor (cam0, imu0, mag0, pressure0, …): from `named`, otherwise from the rig file. Throws
/// InputError where a camera of `rig` or the IMU has none, and UsageError for a sensor that the rig does not
/// have. Removes other sensors without a topic from the rig.
std::map<std::string, std::string> chooseLiveTopics(const RigFile& rig_file,
                                                    const std::map<std::string, std::string>& named,
                                                    Rig* rig);

/// A topic to subscribe to, and the types that its messages may have.
struct SensorTopic {
  std::string sensor, topic;
  std::vector<messages::Type> types;
  bool is_half = false;  ///< whether the IMU has two topics, for gyroscope and accelerometer

  bool isCamera() const;
};

/// The topics to subscribe to. Two topics with a comma between them are the halves of an IMU, in any order.
/// Throws UsageError for several topics of another sensor, and for a topic that two sensors have.
std::vector<SensorTopic> subscriptionsOf(const std::map<std::string, std::string>& topics);

}  // namespace lodeline
