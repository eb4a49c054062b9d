#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/chunks/chunk_cache.h"
#include "lodeline/io/rosbag/container/bag_file.h"
#include "lodeline/io/rosbag/ros2/bag_database.h"
#include "lodeline/io/rosbag/ros2/unpacked_file.h"

namespace lodeline {

/// A ROS 2 bag opened for reading: one or several files in SQLite or MCAP; see BagFile. The messages of all
/// files are in the order of the times at which they were recorded. Files and messages that are compressed
/// with zstd are recognized by their bytes.
class Ros2Bag : public BagFile {
 public:
  /// `bag`: a file or a folder, see findBagParts. Throws InputError like findBagParts, scanMcap and
  /// BagDatabase, and for a bag without messages. Reports files with fewer messages than metadata.yaml states
  /// as `bag_truncated`. `diagnostics` must outlive the object.
  Ros2Bag(const std::filesystem::path& bag, Diagnostics* diagnostics);

  const std::filesystem::path& file() const override { return bag_; }
  std::optional<wire::Bytes> stored(const BagEntry& entry) override;

 private:
  void addPart(const std::filesystem::path& file, BagContents* contents);
  std::optional<wire::Bytes> fromChunk(const BagEntry& entry);
  void reportLoss(const BagEntry& entry);

  std::filesystem::path bag_;
  std::vector<UnpackedFile> files_;
  ChunkCache chunks_;
  std::vector<BagDatabase> databases_;
};

}  // namespace lodeline
