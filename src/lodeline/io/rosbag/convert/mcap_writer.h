#pragma once

#include <filesystem>
#include <string>

#include "lodeline/io/rosbag/convert/bag_writer.h"
#include "lodeline/io/rosbag/convert/mcap_file_writer.h"
#include "lodeline/io/rosbag/convert/ros2_messages.h"

namespace lodeline {

/// Writes a bag of ROS 2 as an MCAP file with chunks, message indexes and a summary.
class McapWriter : public BagWriter {
 public:
  /// `compression` of the chunks: "none", "lz4" or "zstd". `metadata`: file to write at the end; empty for
  /// none. Throws InputError where the file cannot be written.
  McapWriter(const std::filesystem::path& file, std::string compression, std::filesystem::path metadata);

  void write(const std::string& topic, const std::string& type, Time received, wire::Bytes message) override;
  bool takesStored(const BagConnection& connection) const override { return isStoredRos2(connection); }
  void writeStored(const BagConnection& connection, Time received, wire::Bytes message) override;
  void close() override;

 private:
  void add(const WrittenTopic& topic, bool is_new, Time received, const wire::Bytes& message);

  std::string file_name_;
  std::filesystem::path metadata_;
  McapFileWriter file_;
  Ros2Messages messages_;
};

}  // namespace lodeline
