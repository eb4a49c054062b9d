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

/// A file with random access. Throws InputError where it cannot be opened.
class RandomAccessFile {
 public:
  explicit RandomAccessFile(std::filesystem::path path);
  ~RandomAccessFile();
  RandomAccessFile(const RandomAccessFile&) = delete;
  RandomAccessFile& operator=(const RandomAccessFile&) = delete;

  /// Reads up to `size` bytes from `position`; fewer where the file ends or cannot be read.
  wire::Bytes read(uint64_t position, size_t size) const;
  uint64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  uint64_t size_ = 0;
};

/// Position and size of a chunk of messages in a bag.
struct BagChunk {
  uint64_t position = 0;       ///< position of its data in the file
  uint32_t packed_size = 0;    ///< number of bytes available in the file
  uint32_t unpacked_size = 0;  ///< as stated in the chunk
  std::string compression;
  bool is_cut_off = false;  ///< whether the end of the file truncates it
};

/// Cache of a bag's chunks. It keeps the chunks unpacked last, because several topics are read in parallel.
/// In sequential reading, it unpacks the next bzip2 chunks in advance on separate threads: 10 MB take most of
/// a second of processor time.
class ChunkCache {
 public:
  explicit ChunkCache(const std::filesystem::path& file) : file_(file) {}

  const std::filesystem::path& file() const { return file_.path(); }
  const RandomAccessFile& bytes() const { return file_; }
  /// Adds a chunk and returns its number.
  uint32_t add(const BagChunk& chunk);
  const BagChunk& chunk(uint32_t number) const { return chunks_[number]; }
  size_t count() const { return chunks_.size(); }

  std::shared_ptr<const Unpacked> unpack(uint32_t number);

  /// Reads at most `size` bytes of a chunk from `offset`. An uncompressed chunk is not loaded as a whole.
  wire::Bytes read(uint32_t number, uint32_t offset, size_t size);

 private:
  using Unpacking = std::shared_ptr<const Unpacked>;

  Unpacking unpackNow(const BagChunk& chunk) const;
  void unpackAhead(uint32_t from);

  RandomAccessFile file_;
  std::vector<BagChunk> chunks_;
  std::deque<std::pair<uint32_t, Unpacking>> unpacked_;  ///< most recently used first
  std::optional<uint32_t> newest_;                       ///< chunk unpacked last
  std::map<uint32_t, std::future<Unpacking>> ahead_;
};

}  // namespace lodeline
