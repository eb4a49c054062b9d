#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "lodeline/io/rosbag/chunks/wire.h"
#include "lodeline/io/rosbag/definitions/type_description.h"

namespace lodeline::definitions {

/// Reads the fields of a message from the front, in ROS 1's serialization or in CDR. CDR (OMG's Common Data
/// Representation, XCDR1) aligns numbers to their size, counted from the end of a 4-byte header that states
/// the byte order. Throws wire::Reader::CutOff where the bytes end within a field, and DefinitionError for a
/// CDR encapsulation that ROS does not use.
class FieldReader {
 public:
  FieldReader(std::span<const uint8_t> message, Serialization serialization);

  bool isSwapped() const { return swap_; }
  size_t position() const { return position_; }
  /// Continues at a position that position() returned.
  void seek(size_t position) { position_ = position; }
  size_t remaining() const { return bytes_.size() - position_; }

  template <typename Number>
  Number number() {
    const std::span<const uint8_t> raw = take(sizeof(Number), sizeof(Number));
    std::array<uint8_t, sizeof(Number)> copy;
    std::copy(raw.begin(), raw.end(), copy.begin());
    if (swap_) std::reverse(copy.begin(), copy.end());
    return std::bit_cast<Number>(copy);
  }

  /// The bytes of `count` numbers of `size` bytes each, in the message's byte order.
  std::span<const uint8_t> numbers(size_t size, size_t count);
  /// A string without the zero that ends it in CDR.
  std::string_view text();
  /// The characters of a wide string as UTF-8. CDR of ROS 2 has 4 bytes per character.
  std::string wideText();
  /// Number of elements of a field.
  uint32_t count(const Field& field);

  /// Passes over a field or a message.
  void skip(const TypeDescription& type, const Field& field);
  void skip(const TypeDescription& type, const MessageDescription& message);

  /// Counts a step of decoding; throws CutOff where a message takes absurdly many.
  void step();

 private:
  std::span<const uint8_t> take(size_t size, size_t alignment);

  std::span<const uint8_t> bytes_;
  size_t position_ = 0;
  size_t origin_ = 0;  ///< position from which alignment counts
  size_t greatest_alignment_ = 1;
  bool is_cdr_ = false;
  bool swap_ = false;
  size_t steps_left_ = 0;
};

}  // namespace lodeline::definitions
