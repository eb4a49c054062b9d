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

#include "lodeline/io/rosbag/chunks/decompress.h"

namespace lodeline {

/// Number of bytes to read of a message at first; includes every complete message except images.
inline constexpr size_t kMessageAtOnce = 1024;

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
  uint32_t checksum = 0;    ///< CRC-32 of the unpacked bytes; 0 where the chunk has none
  uint32_t file = 0;        ///< number of the file in the cache
  bool is_cut_off = false;  ///< whether the end of the file truncates it
};

/// Cache of a bag's chunks, which may be in several files. It keeps the chunks unpacked last, because several
/// topics are read in parallel. In sequential reading, it unpacks the next bzip2 chunks in advance on
/// separate threads: 10 MB take most of a second of processor time.
class ChunkCache {
 public:
  ChunkCache() = default;
  explicit ChunkCache(const std::filesystem::path& file) { addFile(file); }

  /// Opens another file and returns its number; chunks name their file by it.
  uint32_t addFile(const std::filesystem::path& file);
  const std::filesystem::path& file() const { return files_.front()->path(); }
  const RandomAccessFile& bytes(uint32_t file = 0) const { return *files_[file]; }
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

  std::vector<std::unique_ptr<RandomAccessFile>> files_;
  std::vector<BagChunk> chunks_;
  std::deque<std::pair<uint32_t, Unpacking>> unpacked_;  ///< most recently used first
  std::optional<uint32_t> newest_;                       ///< chunk unpacked last
  std::map<uint32_t, std::future<Unpacking>> ahead_;
};

}  // namespace lodeline
