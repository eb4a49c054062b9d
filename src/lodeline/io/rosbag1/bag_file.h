#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/rosbag1/bag_scan.h"
#include "lodeline/io/rosbag1/chunk_cache.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// All messages of one topic and type, in the order in which they were received.
struct BagTopic {
  BagConnection connection;
  std::vector<BagEntry> entries;
};

/// A ROS 1 bag (format 2.0), opened for reading: which messages it holds, and the bytes of each. Memory: 16
/// bytes a message and a few unpacked chunks.
///
/// Reads by itself rather than through librosbag, because that refuses bags that were not closed or were cut
/// off, and keeps a single chunk unpacked, so that reading several topics side by side would unpack every
/// compressed chunk many times over.
class BagFile {
 public:
  /// Throws InputError where the file cannot be opened, is no bag of format 2.0, is encrypted, or holds no
  /// message. What is damaged or missing is reported as `bag_unindexed`, `bag_truncated`, `bag_damaged` and
  /// `bag_chunk`. `diagnostics` must outlive the object.
  BagFile(const std::filesystem::path& file, Diagnostics* diagnostics);

  const std::filesystem::path& file() const { return chunks_.file(); }
  /// Sorted by name, then type.
  const std::vector<BagTopic>& topics() const { return topics_; }

  /// The bytes of a message; nothing where they are damaged, which is reported.
  std::optional<wire::Bytes> read(const BagEntry& entry);

 private:
  ChunkCache chunks_;
  Diagnostics* diagnostics_;
  std::vector<BagTopic> topics_;
};

}  // namespace lodeline
