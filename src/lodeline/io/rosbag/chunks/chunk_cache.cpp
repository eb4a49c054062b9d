#include "lodeline/io/rosbag/chunks/chunk_cache.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <libdeflate.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <thread>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

/// Two cameras, the IMU and three slower sensors, which may all be in different chunks.
constexpr size_t kKeptChunks = 8;
constexpr size_t kMostKeptBytes = size_t{256} << 20;
/// Number of threads that unpack in advance; each holds a chunk.
constexpr uint32_t kMostThreads = 4;

}  // namespace

RandomAccessFile::RandomAccessFile(std::filesystem::path path) : path_(std::move(path)) {
  struct stat status {};
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0) {
    const std::string reason = std::strerror(errno);
    if (descriptor_ >= 0) ::close(descriptor_);
    throw InputError(fmt::format("{}: cannot be opened: {}", path_.string(), reason));
  }
  size_ = static_cast<uint64_t>(status.st_size);
}

RandomAccessFile::~RandomAccessFile() { ::close(descriptor_); }

wire::Bytes RandomAccessFile::read(uint64_t position, size_t size) const {
  if (position >= size_) return {};
  wire::Bytes bytes(std::min<uint64_t>(size, size_ - position));
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count =
        ::pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(position + done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<size_t>(count);
  }
  bytes.resize(done);
  return bytes;
}

uint32_t ChunkCache::addFile(const std::filesystem::path& file) {
  files_.push_back(std::make_unique<RandomAccessFile>(file));
  return static_cast<uint32_t>(files_.size() - 1);
}

uint32_t ChunkCache::add(const BagChunk& chunk) {
  chunks_.push_back(chunk);
  return static_cast<uint32_t>(chunks_.size() - 1);
}

ChunkCache::Unpacking ChunkCache::unpackNow(const BagChunk& chunk) const {
  Unpacked unpacked = unpackChunk(
      chunk.compression, bytes(chunk.file).read(chunk.position, chunk.packed_size), chunk.unpacked_size);
  const bool has_checksum = chunk.checksum != 0 && unpacked.problem.empty();
  if (has_checksum && libdeflate_crc32(0, unpacked.bytes.data(), unpacked.bytes.size()) != chunk.checksum) {
    unpacked = {{}, "its checksum is wrong"};
  }
  return std::make_shared<const Unpacked>(std::move(unpacked));
}

void ChunkCache::unpackAhead(uint32_t from) {
  std::erase_if(ahead_, [&](const auto& entry) { return entry.first < from; });
  const uint32_t threads = std::clamp(std::thread::hardware_concurrency(), 1U, kMostThreads);
  const uint32_t end = std::min(from + threads, static_cast<uint32_t>(chunks_.size()));
  for (uint32_t number = from; number < end; ++number) {
    if (chunks_[number].compression != "bz2" || ahead_.contains(number)) continue;
    ahead_[number] =
        std::async(std::launch::async, [this, chunk = chunks_[number]] { return unpackNow(chunk); });
  }
}

std::shared_ptr<const Unpacked> ChunkCache::unpack(uint32_t number) {
  const auto known = std::find_if(unpacked_.begin(), unpacked_.end(),
                                  [&](const auto& kept) { return kept.first == number; });
  if (known != unpacked_.end()) {
    std::rotate(unpacked_.begin(), known, known + 1);
    return unpacked_.front().second;
  }
  const auto started = ahead_.find(number);
  Unpacking unpacked = started == ahead_.end() ? unpackNow(chunks_[number]) : started->second.get();
  if (started != ahead_.end()) ahead_.erase(started);
  if (newest_ && number == *newest_ + 1) unpackAhead(number + 1);
  newest_ = number;
  unpacked_.emplace_front(number, unpacked);
  size_t kept_bytes = 0;
  for (const auto& [kept_number, kept] : unpacked_) kept_bytes += kept->bytes.size();
  while (unpacked_.size() > kKeptChunks || (unpacked_.size() > 1 && kept_bytes > kMostKeptBytes)) {
    kept_bytes -= unpacked_.back().second->bytes.size();
    unpacked_.pop_back();
  }
  return unpacked;
}

wire::Bytes ChunkCache::read(uint32_t number, uint32_t offset, size_t size) {
  const BagChunk& chunk = chunks_[number];
  if (chunk.compression == "none") {
    if (offset >= chunk.packed_size) return {};
    return bytes(chunk.file)
        .read(chunk.position + offset, std::min<size_t>(size, chunk.packed_size - offset));
  }
  const std::shared_ptr<const Unpacked> unpacked = unpack(number);
  if (offset >= unpacked->bytes.size()) return {};
  const auto first = unpacked->bytes.begin() + offset;
  return {first, first + static_cast<std::ptrdiff_t>(std::min(size, unpacked->bytes.size() - offset))};
}

}  // namespace lodeline
