#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lodeline/io/rosbag/convert/bag_writer.h"
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
  /// A chunk that is written, for the summary.
  struct WrittenChunk {
    Time first, last;
    uint64_t position = 0, size = 0;
    std::map<uint16_t, uint64_t> indexes;  ///< position of the message index by channel
    uint64_t indexes_size = 0;
    uint64_t packed_size = 0, unpacked_size = 0;
  };

  void add(WrittenTopic* topic, bool is_new, Time received, const wire::Bytes& message);
  void finishChunk();
  void writeSummary();
  void put(const wire::Bytes& bytes);

  std::filesystem::path file_, metadata_;
  std::string compression_;
  std::ofstream stream_;
  uint64_t position_ = 0;
  Ros2Messages messages_;
  wire::Bytes chunk_;  ///< records of the current chunk
  Time chunk_first_, chunk_last_;
  std::map<uint16_t, std::vector<std::pair<Time, uint64_t>>> index_;  ///< of the current chunk
  std::vector<WrittenChunk> chunks_;
};

}  // namespace lodeline
