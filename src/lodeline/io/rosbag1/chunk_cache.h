#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/rosbag1/decompress.h"

namespace lodeline {

/// A file read at any place. Throws InputError where it cannot be opened.
class RandomAccessFile {
 public:
  explicit RandomAccessFile(std::filesystem::path path);
  ~RandomAccessFile();
  RandomAccessFile(const RandomAccessFile&) = delete;
  RandomAccessFile& operator=(const RandomAccessFile&) = delete;

  /// Up to `size` bytes from `position` on; fewer where the file ends or cannot be read.
  wire::Bytes read(uint64_t position, size_t size) const;
  uint64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  uint64_t size_ = 0;
};

/// Where a chunk of messages lies in a bag.
struct BagChunk {
  uint64_t position = 0;       ///< of its data in the file
  uint32_t packed_size = 0;    ///< bytes in the file, as far as the file goes
  uint32_t unpacked_size = 0;  ///< as the chunk says
  std::string compression;
  bool is_cut_off = false;  ///< by the end of the file
};

/// The chunks of a bag; those unpacked last are kept, as several topics are read side by side. While chunks
/// are read one after the other, the next ones that bzip2 packed, which takes a processor most of a second
/// for 10 MB, are unpacked ahead on threads of their own.
class ChunkCache {
 public:
  explicit ChunkCache(const std::filesystem::path& file) : file_(file) {}

  const std::filesystem::path& file() const { return file_.path(); }
  const RandomAccessFile& bytes() const { return file_; }
  /// Returns the number of the chunk.
  uint32_t add(const BagChunk& chunk);
  const BagChunk& chunk(uint32_t number) const { return chunks_[number]; }
  size_t count() const { return chunks_.size(); }

  std::shared_ptr<const Unpacked> unpack(uint32_t number);

  /// Bytes of a chunk from `offset` on, at most `size`, without unpacking the whole of it where it is not
  /// compressed.
  wire::Bytes read(uint32_t number, uint32_t offset, size_t size);

 private:
  using Unpacking = std::shared_ptr<const Unpacked>;

  Unpacking unpackNow(const BagChunk& chunk) const;
  void unpackAhead(uint32_t from);

  RandomAccessFile file_;
  std::vector<BagChunk> chunks_;
  std::deque<std::pair<uint32_t, Unpacking>> unpacked_;  ///< used last in front
  std::optional<uint32_t> newest_;                       ///< unpacked last
  std::map<uint32_t, std::future<Unpacking>> ahead_;
};

}  // namespace lodeline
