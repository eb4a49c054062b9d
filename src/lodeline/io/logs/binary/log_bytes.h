#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

#include "lodeline/io/tables/byte_source.h"

namespace lodeline {

/// Sequential reading of a binary stream with a view ahead. It keeps only that view in memory.
class LogBytes {
 public:
  explicit LogBytes(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {}

  /// The next `count` bytes without taking them; fewer at the end of the stream. Valid until the next call.
  std::span<const uint8_t> peek(size_t count);
  /// Moves `count` bytes forward, at most to the end.
  void skip(size_t count);
  /// Moves forward to the next occurrence of `pattern`; returns false, at the end, where there is none.
  bool find(std::span<const uint8_t> pattern);
  /// Number of bytes before the next one.
  uint64_t position() const { return position_; }

 private:
  std::unique_ptr<ByteSource> source_;
  std::vector<uint8_t> buffer_;
  size_t begin_ = 0;
  uint64_t position_ = 0;
  bool is_at_end_ = false;
};

/// The number of type `Number` at the start of `bytes`, little endian; `bytes` must be long enough.
template <typename Number>
Number littleEndian(std::span<const uint8_t> bytes) {
  Number number;
  std::memcpy(&number, bytes.data(), sizeof(Number));
  return number;
}

}  // namespace lodeline
