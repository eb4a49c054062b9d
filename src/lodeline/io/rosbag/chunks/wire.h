#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "lodeline/types.h"

/// Functions for ROS 1's serialization: little endian, no padding; a 32-bit length precedes each string and
/// each list of variable length (wiki.ros.org/roscpp/Overview/MessagesSerializationAndAdaptingTypes). The
/// code assumes a little-endian machine, as every platform of Debian with Embree is.
namespace lodeline::wire {

using Bytes = std::vector<uint8_t>;

/// Reads values from the front of a message. Throws CutOff where the bytes end within a value.
class Reader {
 public:
  class CutOff : public std::runtime_error {
   public:
    CutOff() : std::runtime_error("the message is shorter than its type") {}
  };

  explicit Reader(std::span<const uint8_t> bytes) : rest_(bytes) {}

  template <typename Number>
  Number take() {
    static_assert(std::is_arithmetic_v<Number>);
    Number number;
    std::memcpy(&number, takeBytes(sizeof(Number)).data(), sizeof(Number));
    return number;
  }

  std::span<const uint8_t> takeBytes(size_t count) {
    if (rest_.size() < count) throw CutOff();
    const std::span<const uint8_t> front = rest_.first(count);
    rest_ = rest_.subspan(count);
    return front;
  }

  /// Reads a string or a list of bytes.
  std::span<const uint8_t> takeSized() { return takeBytes(take<uint32_t>()); }

  std::string_view takeText() {
    const std::span<const uint8_t> text = takeSized();
    return {reinterpret_cast<const char*>(text.data()), text.size()};
  }

  /// Reads a time: seconds and nanoseconds, 32 bits each.
  Time takeTime() {
    const int64_t seconds = take<uint32_t>();
    return Time::fromNanoseconds(seconds * 1'000'000'000 + take<uint32_t>());
  }

  size_t remaining() const { return rest_.size(); }

 private:
  std::span<const uint8_t> rest_;
};

/// Appends values to a message.
class Writer {
 public:
  template <typename Number>
  void put(Number number) {
    static_assert(std::is_arithmetic_v<Number>);
    append(&number, sizeof(Number));
  }

  void putSized(std::span<const uint8_t> bytes) {
    put(static_cast<uint32_t>(bytes.size()));
    if (!bytes.empty()) append(bytes.data(), bytes.size());
  }

  void putText(std::string_view text) {
    putSized({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  }

  /// `time` must not be negative or after 2106 (see isWritable()).
  void putTime(Time time) {
    put(static_cast<uint32_t>(time.nanoseconds() / 1'000'000'000));
    put(static_cast<uint32_t>(time.nanoseconds() % 1'000'000'000));
  }

  Bytes take() { return std::move(bytes_); }

 private:
  void append(const void* first, size_t count) {
    const size_t before = bytes_.size();
    bytes_.resize(before + count);
    std::memcpy(bytes_.data() + before, first, count);
  }

  Bytes bytes_;
};

/// Whether ROS can represent the time: whole seconds since its epoch as an unsigned 32-bit number.
inline bool isWritable(Time time) {
  return time.nanoseconds() >= 0 && time.nanoseconds() / 1'000'000'000 <= int64_t{UINT32_MAX};
}

}  // namespace lodeline::wire
