#include "lodeline/io/logs/files/zip_archive.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <span>
#include <string_view>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kEndMark = "PK\5\6"sv, kEntryMark = "PK\1\2"sv, kLocalMark = "PK\3\4"sv;
constexpr size_t kEndSize = 22, kEntrySize = 46, kLocalSize = 30;
constexpr size_t kLongestComment = 0xFFFF;
constexpr uint32_t kZip64 = 0xFFFFFFFF;
constexpr uint16_t kStored = 0, kDeflated = 8;

uint32_t numberAt(std::string_view bytes, size_t offset, size_t size) {
  uint32_t number = 0;
  for (size_t i = 0; i < size; ++i)
    number |= static_cast<uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << (8 * i);
  return number;
}

std::string bytesAt(std::ifstream& stream, uint64_t offset, size_t size) {
  std::string bytes(size, '\0');
  stream.clear();
  stream.seekg(static_cast<std::streamoff>(offset));
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  return bytes;
}

/// Reads a part of a file, and inflates it where it is deflated.
class ZipSource : public ByteSource {
 public:
  ZipSource(std::ifstream stream, uint64_t size, bool is_deflated, std::string name)
      : stream_(std::move(stream)), rest_(size), is_deflated_(is_deflated), name_(std::move(name)) {
    // Negative bits: data without the header of zlib.
    if (is_deflated_ && inflateInit2(&inflater_, -MAX_WBITS) != Z_OK)
      throw InputError(name_ + ": no memory to inflate it");
  }
  ~ZipSource() override {
    if (is_deflated_) inflateEnd(&inflater_);
  }
  ZipSource(const ZipSource&) = delete;
  ZipSource& operator=(const ZipSource&) = delete;

  size_t read(char* into, size_t size) override {
    if (!is_deflated_) return readPacked(into, size);
    inflater_.next_out = reinterpret_cast<Bytef*>(into);
    inflater_.avail_out = static_cast<uInt>(size);
    while (inflater_.avail_out == size && !is_at_end_) {
      if (inflater_.avail_in == 0) {
        inflater_.avail_in = static_cast<uInt>(readPacked(packed_.data(), packed_.size()));
        inflater_.next_in = reinterpret_cast<Bytef*>(packed_.data());
        if (inflater_.avail_in == 0) throw InputError(name_ + ": cut off in the archive; copy it again");
      }
      const int result = inflate(&inflater_, Z_NO_FLUSH);
      is_at_end_ = result == Z_STREAM_END;
      if (result != Z_OK && !is_at_end_) throw InputError(name_ + ": damaged in the archive; copy it again");
    }
    return size - inflater_.avail_out;
  }

 private:
  size_t readPacked(char* into, size_t size) {
    stream_.read(into, static_cast<std::streamsize>(std::min<uint64_t>(size, rest_)));
    const auto got = static_cast<size_t>(stream_.gcount());
    rest_ -= got;
    return got;
  }

  std::ifstream stream_;
  uint64_t rest_;
  bool is_deflated_;
  std::string name_;
  z_stream inflater_ = {};
  std::array<char, 1 << 14> packed_;
  bool is_at_end_ = false;
};

}  // namespace

ZipArchive::ZipArchive(const std::filesystem::path& file) : file_(file) {
  std::error_code error;
  const uint64_t size = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  const auto refuse = [&](const char* why) { throw InputError(fmt::format("{}: {}", file.string(), why)); };
  if (error || !stream) refuse("not readable");
  const uint64_t tail_size = std::min<uint64_t>(size, kEndSize + kLongestComment);
  const std::string tail = bytesAt(stream, size - tail_size, static_cast<size_t>(tail_size));
  const size_t end = tail.rfind(kEndMark);
  if (end == std::string::npos || tail.size() - end < kEndSize)
    refuse("an archive (zip) without its end; copy it again");
  const uint32_t directory_size = numberAt(tail, end + 12, 4), directory_offset = numberAt(tail, end + 16, 4);
  if (directory_offset == kZip64 || directory_size == kZip64)
    refuse("an archive of more than 4 GB; unpack it");
  const std::string directory = directory_offset > size || directory_size > size - directory_offset
                                    ? std::string()
                                    : bytesAt(stream, directory_offset, directory_size);
  if (directory.size() != directory_size) refuse("an archive (zip) with a damaged directory; copy it again");
  for (size_t at = 0; directory.size() - at >= kEntrySize;) {
    const std::string_view bytes = std::string_view(directory).substr(at);
    if (!bytes.starts_with(kEntryMark)) break;
    const size_t name_size = numberAt(bytes, 28, 2);
    const size_t whole = kEntrySize + name_size + numberAt(bytes, 30, 2) + numberAt(bytes, 32, 2);
    if (bytes.size() < whole) break;
    ZipEntry entry;
    entry.is_encrypted = (numberAt(bytes, 8, 2) & 1U) != 0;
    entry.method = static_cast<uint16_t>(numberAt(bytes, 10, 2));
    entry.packed_size = numberAt(bytes, 20, 4);
    entry.header_offset = numberAt(bytes, 42, 4);
    entry.name = bytes.substr(kEntrySize, name_size);
    if (!entry.name.ends_with('/')) entries_.push_back(entry);
    at += whole;
  }
}

std::unique_ptr<ByteSource> ZipArchive::open(const ZipEntry& entry) const {
  const std::string name = fmt::format("{}: {}", file_.string(), entry.name);
  if (entry.is_encrypted) throw InputError(name + ": encrypted; unpack the archive with its password");
  if (entry.method != kStored && entry.method != kDeflated)
    throw InputError(fmt::format("{}: packed by method {}; unpack the archive", name, entry.method));
  std::ifstream stream(file_, std::ios::binary);
  const std::string header = bytesAt(stream, entry.header_offset, kLocalSize);
  if (header.size() < kLocalSize || !header.starts_with(kLocalMark))
    throw InputError(name + ": damaged in the archive; copy it again");
  const uint64_t data = entry.header_offset + kLocalSize + numberAt(header, 26, 2) + numberAt(header, 28, 2);
  stream.clear();
  stream.seekg(static_cast<std::streamoff>(data));
  return std::make_unique<ZipSource>(std::move(stream), entry.packed_size, entry.method == kDeflated, name);
}

}  // namespace lodeline
