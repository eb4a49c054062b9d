#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lodeline/io/tables/byte_source.h"

namespace lodeline {

/// A file in a zip archive.
struct ZipEntry {
  std::string name;  ///< with its folders
  uint64_t packed_size = 0;
  uint64_t header_offset = 0;  ///< of its local header
  uint16_t method = 0;
  bool is_encrypted = false;
};

/// The directory of a zip archive (PKWARE, "APPNOTE.TXT"). Reads stored and deflated files.
class ZipArchive {
 public:
  /// Throws InputError where the file is no complete archive, or is larger than 4 GB (zip64).
  explicit ZipArchive(const std::filesystem::path& file);

  const std::vector<ZipEntry>& entries() const { return entries_; }
  /// Opens a file of the archive. Throws InputError where it is encrypted or packed by another method.
  /// Reading throws InputError where its data are damaged.
  std::unique_ptr<ByteSource> open(const ZipEntry& entry) const;

 private:
  std::filesystem::path file_;
  std::vector<ZipEntry> entries_;
};

}  // namespace lodeline
