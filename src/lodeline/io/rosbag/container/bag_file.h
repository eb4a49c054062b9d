#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/chunks/wire.h"
#include "lodeline/io/rosbag/definitions/message_conversion.h"
#include "lodeline/types.h"

namespace lodeline {

/// Position of a message in a bag.
struct BagEntry {
  Time received;
  uint32_t chunk = 0;   ///< number of the chunk in the bag, or of the database
  uint32_t offset = 0;  ///< position in the unpacked bytes of the chunk, or number of the row
};

/// One publisher of messages.
struct BagConnection {
  std::string topic;
  std::string type;    ///< e.g. "sensor_msgs/Imu", also where ROS 2 writes "sensor_msgs/msg/Imu"
  std::string md5sum;  ///< ROS 1's checksum of the definition; empty for a type that Lodeline does not read
  std::string definition;  ///< in the bag; empty where it has none
  /// How the messages are stored; nothing for an encoding that Lodeline does not read.
  std::optional<definitions::Serialization> serialization = definitions::Serialization::Ros1;
  /// ROS 1's checksum in the bag, where it is not md5sum: of another version of the definition.
  std::string other_md5sum = {};
  std::string problem = {};  ///< reason why the messages cannot be decoded; empty where they can
};

/// All messages of one topic and type in the order of reception.
struct BagTopic {
  BagConnection connection;
  std::vector<BagEntry> entries;
  /// Conversion to ROS 1's serialization; null where the messages have it.
  std::shared_ptr<const definitions::MessageConversion> to_ros1 = nullptr;
};

/// Connections and messages of a bag, by the number of the connection.
struct BagContents {
  std::map<uint32_t, BagConnection> connections;
  std::map<uint32_t, std::vector<BagEntry>> entries;  ///< in the order in the file
};

/// A bag of any format opened for reading: the index of its messages, and the bytes of each. Memory use is 16
/// bytes per message and a few unpacked chunks.
class BagFile {
 public:
  virtual ~BagFile() = default;

  virtual const std::filesystem::path& file() const = 0;
  /// Topics sorted by name, then by type.
  const std::vector<BagTopic>& topics() const { return topics_; }

  /// The bytes of a message in ROS 1's serialization, which readers of all formats share. Damaged messages
  /// are reported, and the result is then empty.
  std::optional<wire::Bytes> read(const BagTopic& topic, const BagEntry& entry);

  /// The bytes of a message as stored. Damaged messages are reported, and the result is then empty.
  virtual std::optional<wire::Bytes> stored(const BagEntry& entry) = 0;

 protected:
  explicit BagFile(Diagnostics* diagnostics) : diagnostics_(diagnostics) {}

  /// Takes the topics and their messages, and finds the conversions. Throws InputError where there is none.
  void setTopics(BagContents contents);

  Diagnostics* diagnostics_;

 private:
  std::vector<BagTopic> topics_;
};

/// All fields of a message as text (see definitions::messageText), or the reason why it cannot be decoded.
class MessageLister {
 public:
  MessageLister(const BagTopic& topic, size_t most_elements);

  std::string text(std::span<const uint8_t> stored) const;

 private:
  std::optional<definitions::TypeDescription> type_;
  definitions::Serialization serialization_ = definitions::Serialization::Ros1;
  std::string problem_;
  size_t most_elements_;
};

}  // namespace lodeline
