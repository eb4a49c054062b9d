#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "lodeline/io/rosbag/definitions/message_conversion.h"
#include "lodeline/node/intake/live_imu_halves.h"
#include "lodeline/node/intake/sensor_topics.h"
#include "lodeline/node/intake/sensor_traffic.h"
#include "lodeline/recording.h"

namespace lodeline {

/// Takes the messages of the sensors' topics and pushes their readings into a source. It only copies and
/// parses; the thread that pulls images decodes them. Messages that have a wrong type, are cut off or hold
/// numbers that are not finite are counted and passed over.
class MessageIntake {
 public:
  /// `source` must outlive the intake. `water`: parameters that convert pressure to depth. `serialization`:
  /// that of the messages.
  MessageIntake(std::vector<SensorTopic> topics, const WaterColumn& water,
                definitions::Serialization serialization, LiveSource* source);

  const std::vector<SensorTopic>& topics() const { return topics_; }

  /// Takes a message of a topic, by its place in topics(). `type`: e.g. "sensor_msgs/Imu"; `md5sum`: ROS 1's
  /// checksum of its definition, empty where it is not known. Any thread may call this.
  void receive(size_t topic, const std::string& type, const std::string& md5sum, wire::Bytes message);
  /// Counts messages that the transport lost.
  void addLost(size_t topic, uint64_t messages);
  /// States why nothing can be received on a topic.
  void addProblem(size_t topic, const std::string& problem);

  /// Messages so far, by topic.
  std::vector<SensorTraffic> traffic() const;

 private:
  /// The accepted type of that name; null where there is none.
  static const messages::Type* typeOf(const SensorTopic& topic, const std::string& type,
                                      const std::string& md5sum);
  wire::Bytes inRos1(const std::string& type, wire::Bytes message) const;
  void push(size_t topic, const std::string& type, wire::Bytes message, std::string* problem);
  void pushDvl(DvlSample sample);
  void pushImu(const SensorTopic& topic, std::span<const uint8_t> message, std::string* problem);

  std::vector<SensorTopic> topics_;
  std::vector<size_t> cameras_;  ///< by topic, the camera in the rig
  WaterColumn water_;
  LiveSource* source_;
  std::map<std::string, std::unique_ptr<const definitions::MessageConversion>> to_ros1_;  ///< by type
  mutable std::mutex mutex_;
  std::vector<SensorTraffic> traffic_;  ///< by topic
  std::mutex halves_mutex_;
  LiveImuHalves halves_;
};

}  // namespace lodeline
