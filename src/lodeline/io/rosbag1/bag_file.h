#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag1/bag_scan.h"
#include "lodeline/io/rosbag1/chunk_cache.h"

namespace lodeline {

/// All messages of one topic and type in the order of reception.
struct BagTopic {
  BagConnection connection;
  std::vector<BagEntry> entries;
};

/// A ROS 1 bag (format 2.0) opened for reading: the index of its messages, and the bytes of each. Memory use
/// is 16 bytes per message and a few unpacked chunks.
///
/// Lodeline does not use librosbag for reading. That library refuses bags that were not closed or are
/// truncated. It also keeps a single unpacked chunk, so that parallel reading of several topics would unpack
/// every compressed chunk many times.
class BagFile {
 public:
  /// Throws InputError where the file cannot be opened, is not a bag of format 2.0, is encrypted, or contains
  /// no message. Reports damaged or missing parts as `bag_unindexed`, `bag_truncated`, `bag_damaged` and
  /// `bag_chunk`. `diagnostics` must outlive the object.
  BagFile(const std::filesystem::path& file, Diagnostics* diagnostics);

  const std::filesystem::path& file() const { return chunks_.file(); }
  /// Topics sorted by name, then by type.
  const std::vector<BagTopic>& topics() const { return topics_; }

  /// The bytes of a message. Damaged messages are reported, and the result is then empty.
  std::optional<wire::Bytes> read(const BagEntry& entry);

 private:
  ChunkCache chunks_;
  Diagnostics* diagnostics_;
  std::vector<BagTopic> topics_;
};

}  // namespace lodeline
