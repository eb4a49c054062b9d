#pragma once

#include <algorithm>
#include <span>
#include <string_view>

#include "lodeline/io/rosbag/chunks/wire.h"
#include "lodeline/io/rosbag/definitions/type_description.h"

namespace lodeline::definitions {

/// Writes the fields of a message in ROS 1's serialization or in little-endian CDR; see FieldReader.
class FieldWriter {
 public:
  explicit FieldWriter(Serialization serialization, size_t size_hint = 0)
      : is_cdr_(serialization == Serialization::Cdr) {
    bytes_.reserve(size_hint);
    if (is_cdr_) bytes_.assign({0, 1, 0, 0});
  }

  /// Writes numbers of `size` bytes each; `raw`: their bytes in the byte order of `is_swapped`.
  void numbers(std::span<const uint8_t> raw, size_t size, bool is_swapped) {
    if (raw.empty()) return;
    align(size);
    const size_t before = bytes_.size();
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
    if (!is_swapped || size == 1) return;
    const auto first = bytes_.begin() + static_cast<std::ptrdiff_t>(before);
    for (auto number = first; number != bytes_.end(); number += static_cast<std::ptrdiff_t>(size)) {
      std::reverse(number, number + static_cast<std::ptrdiff_t>(size));
    }
  }

  void count(uint32_t elements) {
    align(sizeof(elements));
    const auto* first = reinterpret_cast<const uint8_t*>(&elements);
    bytes_.insert(bytes_.end(), first, first + sizeof(elements));
  }

  void text(std::string_view text) {
    count(static_cast<uint32_t>(text.size() + (is_cdr_ ? 1 : 0)));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    if (is_cdr_) bytes_.push_back(0);
  }

  /// Writes zeros for a field that the other message does not have.
  void zeros(const TypeDescription& type, const Field& field) {
    if (field.repetition == Repetition::Variable) return count(0);
    for (uint32_t i = 0; i < field.count; ++i) {
      if (field.kind == FieldKind::String) {
        text("");
      } else if (field.kind == FieldKind::WideString) {
        count(0);
      } else if (field.kind == FieldKind::Message) {
        for (const Field& inner : type.messages[field.message].fields) zeros(type, inner);
      } else {
        align(sizeOf(field.kind));
        bytes_.resize(bytes_.size() + sizeOf(field.kind));
      }
    }
  }

  wire::Bytes take() { return std::move(bytes_); }

 private:
  static constexpr size_t kCdrHeader = 4;

  void align(size_t size) {
    if (!is_cdr_) return;
    while ((bytes_.size() - kCdrHeader) % size != 0) bytes_.push_back(0);
  }

  bool is_cdr_;
  wire::Bytes bytes_;
};

}  // namespace lodeline::definitions
