#pragma once

#include <filesystem>
#include <optional>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/chunks/chunk_cache.h"
#include "lodeline/io/rosbag/container/bag_file.h"

namespace lodeline {

/// A ROS 1 bag (format 2.0) opened for reading: see BagFile.
///
/// Lodeline does not use librosbag for reading. That library refuses bags that were not closed or are
/// truncated. It also keeps a single unpacked chunk, so that parallel reading of several topics would unpack
/// every compressed chunk many times.
class Ros1Bag : public BagFile {
 public:
  /// Throws InputError where the file cannot be opened, is not a bag of format 2.0, is encrypted, or contains
  /// no message. Reports damaged or missing parts as `bag_unindexed`, `bag_truncated`, `bag_damaged` and
  /// `bag_chunk`. `diagnostics` must outlive the object.
  Ros1Bag(const std::filesystem::path& file, Diagnostics* diagnostics);

  const std::filesystem::path& file() const override { return chunks_.file(); }
  std::optional<wire::Bytes> stored(const BagEntry& entry) override;

 private:
  ChunkCache chunks_;
};

}  // namespace lodeline
