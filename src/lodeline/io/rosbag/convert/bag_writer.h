#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "lodeline/io/rosbag/chunks/wire.h"

namespace lodeline {

/// Writes messages to a ROS 1 bag with Debian's librosbag-storage.
class BagWriter {
 public:
  /// `compression`: "none", "bz2" or "lz4". Throws InputError where the file cannot be written, and
  /// UsageError where the program was built without librosbag-storage.
  BagWriter(const std::filesystem::path& file, const std::string& compression);
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;

  /// Writes one message. `type`: one of those in messages.h, e.g. "sensor_msgs/Imu". `message` has ROS's
  /// serialization. Throws InputError for a time before 1970 or after 2106, which a bag cannot represent.
  void write(const std::string& topic, const std::string& type, Time received, wire::Bytes message);
  /// Completes the file. Throws InputError on failure.
  void close();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lodeline
