#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

namespace lodeline {

/// A stream of bytes that is read once, from its beginning to its end.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Copies the next bytes, `size` at most. Returns their number, 0 at the end.
  virtual std::size_t read(char* into, std::size_t size) = 0;
};

/// The bytes of a file; a file compressed with gzip gives what it holds. Throws InputError where the file is
/// missing, is a folder or cannot be opened, and while reading where its compression is damaged.
std::unique_ptr<ByteSource> openFile(const std::filesystem::path& file);

/// Bytes that are in memory already.
std::unique_ptr<ByteSource> bytesInMemory(std::string bytes);

/// The same text in UTF-8. UTF-16 is recognized by its byte order mark, or without one by the zero byte in
/// each pair. A byte order mark is left out. Throws InputError, with `name`, where the bytes are no text.
std::unique_ptr<ByteSource> inUtf8(std::unique_ptr<ByteSource> bytes, const std::string& name);

}  // namespace lodeline
