#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "lodeline/io/rosbag/container/bag_file.h"
#include "lodeline/io/rosbag/definitions/message_conversion.h"

namespace lodeline {

/// "sensor_msgs/msg/Imu" for "sensor_msgs/Imu".
std::string ros2TypeName(const std::string& type);

/// Whether messages of a connection can be copied to a bag of ROS 2 unchanged.
bool isStoredRos2(const BagConnection& connection);

/// A topic of a bag of ROS 2 that is written.
struct WrittenTopic {
  uint16_t number = 0;  ///< from 1 on
  std::string name;
  std::string type;  ///< in ROS 2's form
  std::string definition;
  uint64_t messages = 0;
};

/// What both writers of ROS 2 bags need: the topics, and the conversion of messages to CDR.
class Ros2Messages {
 public:
  /// The topic of a name and type, and whether it is new. Throws InputError for more than 65,535 topics, and
  /// for a time that messages of ROS 2 cannot represent: before 1970 or after 2038.
  std::pair<WrittenTopic*, bool> topic(const std::string& name, const std::string& type,
                                       const std::string& definition, Time received);
  /// The definition of a known type as bags contain it.
  const std::string& definitionOf(const std::string& type);
  wire::Bytes toCdr(const std::string& type, const wire::Bytes& message);

  const std::map<std::pair<std::string, std::string>, WrittenTopic>& topics() const { return topics_; }
  uint64_t messages() const;
  Time first() const { return first_; }
  Time last() const { return last_; }

 private:
  std::map<std::pair<std::string, std::string>, WrittenTopic> topics_;  ///< by name and type
  std::map<std::string, std::string> definitions_;
  std::map<std::string, std::unique_ptr<definitions::MessageConversion>> conversions_;
  Time first_, last_;
};

/// The text of metadata.yaml. `file`: name of the file with all messages. `storage`: "sqlite3" or "mcap".
std::string metadataText(const Ros2Messages& messages, const std::string& file, const std::string& storage);

}  // namespace lodeline
