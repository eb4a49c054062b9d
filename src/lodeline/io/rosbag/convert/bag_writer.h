#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "lodeline/io/rosbag/container/bag_file.h"

namespace lodeline {

/// Formats of bags that Lodeline writes: ROS 1 (.bag), ROS 2 in SQLite (.db3) and in MCAP (.mcap).
enum class BagFormat { Ros1, Database, Mcap };

/// Writes messages to a bag.
class BagWriter {
 public:
  virtual ~BagWriter() = default;

  /// Writes one message. `type`: one that readers of Lodeline know, e.g. "sensor_msgs/Imu". `message` has ROS
  /// 1's serialization. Throws InputError for a time that the bag cannot represent.
  virtual void write(const std::string& topic, const std::string& type, Time received,
                     wire::Bytes message) = 0;
  /// Whether messages of a connection can be written in the form in which another bag stores them.
  virtual bool takesStored(const BagConnection& connection) const = 0;
  /// Writes a message as stored, for a connection that takesStored() accepts.
  virtual void writeStored(const BagConnection& connection, Time received, wire::Bytes message) = 0;
  /// Completes the file. Throws InputError on failure.
  virtual void close() = 0;
};

/// Creates a bag. A target of ROS 2 without .db3 or .mcap as its extension becomes a folder with
/// metadata.yaml, which `ros2 bag` reads. `compression`: "none", "lz4", "bz2" (ROS 1) or "zstd" (MCAP); empty
/// for the usual one of the format. Throws InputError where the file cannot be written, and UsageError for a
/// compression that the format does not have, and for ROS 1 without librosbag-storage.
std::unique_ptr<BagWriter> makeBagWriter(const std::filesystem::path& target, BagFormat format,
                                         const std::string& compression);

}  // namespace lodeline
