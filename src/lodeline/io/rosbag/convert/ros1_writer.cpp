#include "lodeline/io/rosbag/convert/ros1_writer.h"

#include <fmt/core.h>
#include <geometry_msgs/PoseStamped.h>
#include <rosbag/bag.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/FluidPressure.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/LaserScan.h>
#include <sensor_msgs/MagneticField.h>
#include <sensor_msgs/Range.h>

#include <map>
#include <utility>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/definitions/known_definitions.h"

namespace lodeline {

/// Description of a message type as rosbag requires it.
struct RosbagType {
  std::string name;
  std::string md5sum;
  std::string definition;
};

namespace {

template <typename Message>
RosbagType describe() {
  return {ros::message_traits::DataType<Message>::value(), ros::message_traits::MD5Sum<Message>::value(),
          ros::message_traits::Definition<Message>::value()};
}

RosbagType describe(const std::string& type) {
  for (RosbagType& known : std::vector<RosbagType>{
           describe<sensor_msgs::Imu>(), describe<sensor_msgs::MagneticField>(),
           describe<sensor_msgs::FluidPressure>(), describe<sensor_msgs::LaserScan>(),
           describe<sensor_msgs::Range>(), describe<sensor_msgs::Image>(),
           describe<sensor_msgs::CompressedImage>(), describe<geometry_msgs::PoseStamped>()}) {
    if (type == known.name) return std::move(known);
  }
  return {type, std::string(definitions::ros1Checksum(type)),
          definitions::fullDefinition(type, definitions::Serialization::Ros1)};
}

/// Serialized bytes with the description of their type. ROS's own message structs are not used because those
/// of Debian 12 do not compile as C++20.
struct SerializedMessage {
  RosbagType type;
  wire::Bytes bytes;
};

}  // namespace
}  // namespace lodeline

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<lodeline::SerializedMessage> {
  static const char* value(const lodeline::SerializedMessage& message) { return message.type.md5sum.c_str(); }
};
template <>
struct DataType<lodeline::SerializedMessage> {
  static const char* value(const lodeline::SerializedMessage& message) { return message.type.name.c_str(); }
};
template <>
struct Definition<lodeline::SerializedMessage> {
  static const char* value(const lodeline::SerializedMessage& message) {
    return message.type.definition.c_str();
  }
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<lodeline::SerializedMessage> {
  template <typename Stream>
  static void write(Stream& stream, const lodeline::SerializedMessage& message) {
    std::memcpy(stream.advance(static_cast<uint32_t>(message.bytes.size())), message.bytes.data(),
                message.bytes.size());
  }
  static uint32_t serializedLength(const lodeline::SerializedMessage& message) {
    return static_cast<uint32_t>(message.bytes.size());
  }
};

}  // namespace serialization
}  // namespace ros

namespace lodeline {

class Ros1Writer::Implementation {
 public:
  std::filesystem::path file;
  rosbag::Bag bag;

  const RosbagType& typeOf(const std::string& type);
  /// Takes a type from another bag.
  void take(RosbagType type) { types_.try_emplace(type.name, type); }

  template <typename Work>
  void guarded(const Work& work) {
    try {
      work();
    } catch (const ros::Exception& error) {
      throw InputError(fmt::format("{}: cannot be written ({}); is there space and permission?",
                                   file.string(), error.what()));
    }
  }

 private:
  std::map<std::string, RosbagType> types_;
};

Ros1Writer::Ros1Writer(const std::filesystem::path& file, const std::string& compression)
    : implementation_(std::make_unique<Implementation>()) {
  implementation_->file = file;
  implementation_->guarded([&] {
    rosbag::Bag& bag = implementation_->bag;
    bag.open(file.string(), rosbag::bagmode::Write);
    if (compression == "bz2") bag.setCompression(rosbag::compression::BZ2);
    if (compression == "lz4") bag.setCompression(rosbag::compression::LZ4);
  });
}

Ros1Writer::~Ros1Writer() = default;

void Ros1Writer::write(const std::string& topic, const std::string& type, Time received,
                       wire::Bytes message) {
  if (!wire::isWritable(received)) {
    throw InputError(
        fmt::format("{}: a bag cannot hold the stamp {} ns of topic {}: its times lie between 1970 "
                    "and 2106",
                    implementation_->file.string(), received.nanoseconds(), topic));
  }
  // ROS treats the time 0 as undefined; the smallest time is 1 ns.
  const int64_t ns = std::max<int64_t>(received.nanoseconds(), 1);
  const ros::Time time(static_cast<uint32_t>(ns / 1'000'000'000), static_cast<uint32_t>(ns % 1'000'000'000));
  implementation_->guarded([&] {
    implementation_->bag.write(topic, time,
                               SerializedMessage{implementation_->typeOf(type), std::move(message)});
  });
}

const RosbagType& Ros1Writer::Implementation::typeOf(const std::string& type) {
  const auto known = types_.find(type);
  if (known != types_.end()) return known->second;
  return types_.emplace(type, describe(type)).first->second;
}

bool Ros1Writer::takesStored(const BagConnection& connection) const {
  return connection.serialization == definitions::Serialization::Ros1 && !connection.definition.empty() &&
         !connection.md5sum.empty();
}

void Ros1Writer::writeStored(const BagConnection& connection, Time received, wire::Bytes message) {
  const bool is_other = !connection.other_md5sum.empty();
  implementation_->take(
      {connection.type, is_other ? connection.other_md5sum : connection.md5sum, connection.definition});
  write(connection.topic, connection.type, received, std::move(message));
}

void Ros1Writer::close() {
  implementation_->guarded([&] { implementation_->bag.close(); });
}

}  // namespace lodeline
