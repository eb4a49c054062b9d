#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

namespace lodeline {

/// A stream of bytes that can be read once from its beginning to its end.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Copies at most `size` next bytes to `into`. Returns their number, 0 at the end.
  virtual std::size_t read(char* into, std::size_t size) = 0;
};

/// Opens a file as a stream; decompresses gzip. Throws InputError where the file is missing, is a folder or
/// cannot be opened. Reading throws InputError where the compressed data is damaged.
std::unique_ptr<ByteSource> openFile(const std::filesystem::path& file);

/// A stream of bytes in memory.
std::unique_ptr<ByteSource> bytesInMemory(std::string bytes);

/// Converts a stream of text to UTF-8. A byte order mark, or a zero byte in each pair, identifies UTF-16.
/// Byte order marks are removed. Throws InputError with `name` where the bytes are not text.
std::unique_ptr<ByteSource> inUtf8(std::unique_ptr<ByteSource> bytes, const std::string& name);

}  // namespace lodeline
