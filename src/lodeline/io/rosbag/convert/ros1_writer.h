#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "lodeline/io/rosbag/convert/bag_writer.h"

namespace lodeline {

/// Writes messages to a ROS 1 bag with Debian's librosbag-storage.
class Ros1Writer : public BagWriter {
 public:
  /// `compression`: "none", "bz2" or "lz4". Throws InputError where the file cannot be written, and
  /// UsageError where the program was built without librosbag-storage.
  Ros1Writer(const std::filesystem::path& file, const std::string& compression);
  ~Ros1Writer() override;
  Ros1Writer(const Ros1Writer&) = delete;
  Ros1Writer& operator=(const Ros1Writer&) = delete;

  void write(const std::string& topic, const std::string& type, Time received, wire::Bytes message) override;
  bool takesStored(const BagConnection& connection) const override;
  void writeStored(const BagConnection& connection, Time received, wire::Bytes message) override;
  void close() override;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lodeline
