#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/store/pack/deflate.h"

namespace lodeline {

using Bytes = std::vector<unsigned char>;

/// Appends numbers, little-endian.
class ByteWriter {
 public:
  template <typename Integer>
  void integer(Integer value) {
    for (size_t i = 0; i < sizeof(Integer); ++i)
      bytes_.push_back(static_cast<unsigned char>(static_cast<uint64_t>(value) >> (8 * i)));
  }
  void real32(double value) { integer(std::bit_cast<uint32_t>(static_cast<float>(value))); }

  /// A column of numbers by significance of the bytes: first the least significant byte of each. Each of
  /// these planes has its own code, since its bytes are similar: the length of the compressed plane and these
  /// bytes, or length 0 and the plane as it is.
  template <typename Integer>
  void column(const std::vector<Integer>& values) {
    Bytes plane(values.size());
    for (size_t i = 0; i < sizeof(Integer); ++i) {
      for (size_t k = 0; k < values.size(); ++k)
        plane[k] = static_cast<unsigned char>(static_cast<uint64_t>(values[k]) >> (8 * i));
      addPlane(plane);
    }
  }

  const Bytes& bytes() const { return bytes_; }

 private:
  void addPlane(const Bytes& plane) {
    if (plane.empty()) return;
    const Bytes compressed = deflated(plane);
    const bool is_shorter = compressed.size() < plane.size();
    length(is_shorter ? compressed.size() : 0);
    const Bytes& kept = is_shorter ? compressed : plane;
    bytes_.insert(bytes_.end(), kept.begin(), kept.end());
  }
  /// Seven bits a byte, the lowest first; the highest bit says that further bytes follow.
  void length(size_t value) {
    for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<unsigned char>(value | 0x80));
    bytes_.push_back(static_cast<unsigned char>(value));
  }

  Bytes bytes_;
};

/// Reads what ByteWriter wrote. Throws InputError where the bytes end too early.
class ByteReader {
 public:
  explicit ByteReader(std::span<const unsigned char> bytes) : bytes_(bytes) {}

  template <typename Integer>
  Integer integer() {
    const auto part = take(sizeof(Integer));
    uint64_t value = 0;
    for (size_t i = 0; i < sizeof(Integer); ++i) value |= static_cast<uint64_t>(part[i]) << (8 * i);
    return static_cast<Integer>(value);
  }
  double real32() { return std::bit_cast<float>(integer<uint32_t>()); }

  template <typename Integer>
  std::vector<Integer> column(size_t count) {
    std::vector<Integer> values(count);
    for (size_t i = 0; i < sizeof(Integer) && count > 0; ++i) {
      const size_t size = length();
      const auto part = take(size > 0 ? size : count);
      const Bytes plane = size > 0 ? inflated(part, count) : Bytes(part.begin(), part.end());
      for (size_t k = 0; k < count; ++k)
        values[k] = static_cast<Integer>(values[k] |
                                         static_cast<Integer>(static_cast<uint64_t>(plane[k]) << (8 * i)));
    }
    return values;
  }

  std::span<const unsigned char> take(size_t size) {
    if (size > bytes_.size()) throw InputError("the data ends too early");
    const auto part = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return part;
  }
  size_t left() const { return bytes_.size(); }

 private:
  size_t length() {
    size_t value = 0;
    for (int shift = 0; shift < 28; shift += 7) {
      const auto byte = integer<uint8_t>();
      value |= static_cast<size_t>(byte & 0x7f) << shift;
      if ((byte & 0x80) == 0) return value;
    }
    throw InputError("a length is too large");
  }

  std::span<const unsigned char> bytes_;
};

}  // namespace lodeline
