#include "lodeline/io/rosbag/definitions/field_reader.h"

#include <fmt/core.h>

namespace lodeline::definitions {
namespace {

constexpr size_t kCdrHeader = 4;
/// Steps of decoding allowed per byte; arrays of messages without fields have no bytes.
constexpr size_t kStepsPerByte = 64;
constexpr size_t kStepsAtLeast = 100'000;

/// Appends a character in UTF-8.
void append(uint32_t c, std::string* text) {
  const auto put = [&](uint32_t byte) { text->push_back(static_cast<char>(byte)); };
  if (c < 0x80) {
    put(c);
  } else if (c < 0x800) {
    put(0xC0 | c >> 6);
    put(0x80 | (c & 0x3F));
  } else if (c < 0x10000) {
    put(0xE0 | c >> 12);
    put(0x80 | (c >> 6 & 0x3F));
    put(0x80 | (c & 0x3F));
  } else {
    put(0xF0 | (c >> 18 & 0x07));
    put(0x80 | (c >> 12 & 0x3F));
    put(0x80 | (c >> 6 & 0x3F));
    put(0x80 | (c & 0x3F));
  }
}

}  // namespace

FieldReader::FieldReader(std::span<const uint8_t> message, Serialization serialization)
    : bytes_(message), steps_left_(kStepsAtLeast + kStepsPerByte * message.size()) {
  if (serialization == Serialization::Ros1) return;
  is_cdr_ = true;
  if (bytes_.size() < kCdrHeader) throw wire::Reader::CutOff();
  const int encapsulation = bytes_[0] << 8 | bytes_[1];
  // Plain CDR is 0 and 1, big and little endian; plain XCDR2, 6 and 7, aligns to 4 bytes at most.
  const bool is_second = encapsulation == 6 || encapsulation == 7;
  if (encapsulation > 1 && !is_second) {
    throw DefinitionError(
        fmt::format("has the CDR encapsulation {:#06x}, which is not supported", encapsulation));
  }
  greatest_alignment_ = is_second ? 4 : 8;
  swap_ = encapsulation % 2 == 0;
  position_ = origin_ = kCdrHeader;
}

std::span<const uint8_t> FieldReader::take(size_t size, size_t alignment) {
  if (is_cdr_) {
    const size_t step = std::min(alignment, greatest_alignment_);
    const size_t past = (position_ - origin_) % step;
    if (past != 0) position_ += step - past;
  }
  if (position_ > bytes_.size() || bytes_.size() - position_ < size) throw wire::Reader::CutOff();
  const std::span<const uint8_t> taken = bytes_.subspan(position_, size);
  position_ += size;
  return taken;
}

std::span<const uint8_t> FieldReader::numbers(size_t size, size_t count) {
  if (count == 0) return {};
  if (count > bytes_.size() / size) throw wire::Reader::CutOff();
  return take(size * count, size);
}

std::string_view FieldReader::text() {
  const auto size = number<uint32_t>();
  const std::span<const uint8_t> bytes = take(size, 1);
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (is_cdr_ && text.ends_with('\0')) text.remove_suffix(1);
  return text;
}

std::string FieldReader::wideText() {
  const auto size = number<uint32_t>();
  if (size > remaining() / sizeof(uint32_t)) throw wire::Reader::CutOff();
  std::string text;
  for (uint32_t i = 0; i < size; ++i) append(number<uint32_t>(), &text);
  return text;
}

uint32_t FieldReader::count(const Field& field) {
  return field.repetition == Repetition::Variable ? number<uint32_t>() : field.count;
}

void FieldReader::step() {
  if (steps_left_-- == 0) throw wire::Reader::CutOff();
}

void FieldReader::skip(const TypeDescription& type, const Field& field) {
  const uint32_t elements = count(field);
  const size_t size = sizeOf(field.kind);
  if (size > 0) {
    numbers(size, elements);
    return;
  }
  for (uint32_t i = 0; i < elements; ++i) {
    step();
    if (field.kind == FieldKind::String) {
      text();
    } else if (field.kind == FieldKind::WideString) {
      wideText();
    } else {
      skip(type, type.messages[field.message]);
    }
  }
}

void FieldReader::skip(const TypeDescription& type, const MessageDescription& message) {
  step();
  for (const Field& field : message.fields) skip(type, field);
}

}  // namespace lodeline::definitions
