#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lodeline/io/rosbag/chunks/wire.h"

namespace lodeline {

/// A topic of an MCAP file with the schema of its messages.
struct McapChannel {
  std::string topic;
  std::string message_encoding;  ///< "cdr", "json"
  std::string schema_name;
  std::string schema_encoding;  ///< "ros2msg", "jsonschema"
  std::string schema;
  std::map<std::string, std::string> metadata = {};
};

/// Writes messages of any encoding to an MCAP file with chunks, message indexes and a summary.
class McapFileWriter {
 public:
  /// `compression` of the chunks: "none", "lz4" or "zstd". `profile`: the convention of the topics and
  /// encodings; may be empty. Throws InputError where the file cannot be written.
  McapFileWriter(const std::filesystem::path& file, std::string compression, const std::string& profile);

  /// Adds a channel and returns its number, from 1 on. Throws InputError for more than 65,535 channels.
  uint16_t addChannel(McapChannel channel);
  /// Writes one message of a channel. `time` must not be negative.
  void write(uint16_t channel, Time time, std::span<const uint8_t> message);
  /// Completes the file. Throws InputError on failure.
  void close();

 private:
  struct WrittenChannel {
    McapChannel channel;
    uint64_t messages = 0;
  };
  /// A chunk that is written, for the summary.
  struct WrittenChunk {
    Time first, last;
    uint64_t position = 0, size = 0;
    std::map<uint16_t, uint64_t> indexes;  ///< position of the message index by channel
    uint64_t indexes_size = 0;
    uint64_t packed_size = 0, unpacked_size = 0;
  };

  /// Numbers of the channels in the order of topic and name of the schema.
  std::vector<uint16_t> channelsByName() const;
  void finishChunk();
  void writeSummary();
  void put(const wire::Bytes& bytes);

  std::filesystem::path file_;
  std::string compression_;
  std::ofstream stream_;
  uint64_t position_ = 0;
  std::vector<WrittenChannel> channels_;  ///< number 1 is the first
  wire::Bytes chunk_;                     ///< records of the current chunk
  Time chunk_first_, chunk_last_;
  std::map<uint16_t, std::vector<std::pair<Time, uint64_t>>> index_;  ///< of the current chunk
  std::vector<WrittenChunk> chunks_;
};

}  // namespace lodeline
