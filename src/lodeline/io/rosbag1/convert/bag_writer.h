#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "lodeline/io/rosbag1/wire.h"

namespace lodeline {

/// Writes messages into a ROS 1 bag, through Debian's librosbag-storage.
class BagWriter {
 public:
  /// `compression`: "none", "bz2" or "lz4". Throws InputError where the file cannot be written, and
  /// UsageError where the program was built without librosbag-storage.
  BagWriter(const std::filesystem::path& file, const std::string& compression);
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  /// `type`: e.g. "sensor_msgs/Imu"; of those in messages.h. `message` in ROS's serialization. Throws
  /// InputError for a time before 1970 or after 2106, which a bag cannot hold.
  void write(const std::string& topic, const std::string& type, Time received, wire::Bytes message);
  /// Completes the file. Throws InputError where that fails.
  void close();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lodeline
