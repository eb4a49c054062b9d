#include "lodeline/io/rosbag/convert/bag_writer.h"

#include <fmt/core.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/convert/database_writer.h"
#include "lodeline/io/rosbag/convert/mcap_writer.h"
#include "lodeline/io/rosbag/convert/ros1_writer.h"

namespace lodeline {
namespace {

/// The compression to use. Throws UsageError where the format does not have it.
std::string settleCompression(BagFormat format, const std::string& given) {
  const bool is_mcap = format == BagFormat::Mcap;
  if (given.empty()) return is_mcap ? "zstd" : "none";
  const bool is_possible = given == "none" || (given == "lz4" && format != BagFormat::Database) ||
                           (given == "bz2" && format == BagFormat::Ros1) || (given == "zstd" && is_mcap);
  if (is_possible) return given;
  throw UsageError(
      fmt::format("--compression {}: ROS 1 bags have none, lz4, bz2; MCAP has none, lz4, zstd; "
                  "db3 has none",
                  given));
}

}  // namespace

std::unique_ptr<BagWriter> makeBagWriter(const std::filesystem::path& target, BagFormat format,
                                         const std::string& compression) {
  const std::string settled = settleCompression(format, compression);
  if (format == BagFormat::Ros1) return std::make_unique<Ros1Writer>(target, settled);
  const std::string extension = format == BagFormat::Mcap ? ".mcap" : ".db3";
  std::filesystem::path file = target, metadata;
  if (target.extension() != extension) {
    const std::filesystem::path folder = target.has_filename() ? target : target.parent_path();
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    file = folder / (folder.filename().string() + "_0" + extension);
    metadata = folder / "metadata.yaml";
  }
  if (format == BagFormat::Mcap) return std::make_unique<McapWriter>(file, settled, metadata);
  return std::make_unique<DatabaseWriter>(file, metadata);
}

}  // namespace lodeline
