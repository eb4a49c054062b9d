#include "lodeline/io/rosbag/ros1/record.h"

#include <algorithm>

namespace lodeline {

std::optional<RecordFields> RecordFields::parse(std::span<const uint8_t> bytes) {
  RecordFields result;
  wire::Reader reader(bytes);
  try {
    while (reader.remaining() > 0) {
      const std::span<const uint8_t> field = reader.takeSized();
      const auto equals = std::find(field.begin(), field.end(), uint8_t{'='});
      if (equals == field.end()) return std::nullopt;
      result.fields_.emplace(std::string(field.begin(), equals), wire::Bytes(equals + 1, field.end()));
    }
  } catch (const wire::Reader::CutOff&) {
    return std::nullopt;
  }
  return result;
}

template <typename Number>
std::optional<Number> RecordFields::number(const std::string& name) const {
  const auto field = fields_.find(name);
  if (field == fields_.end() || field->second.size() != sizeof(Number)) return std::nullopt;
  return wire::Reader(field->second).take<Number>();
}

std::optional<RecordKind> RecordFields::kind() const {
  const std::optional<uint8_t> kind = number<uint8_t>("op");
  if (!kind || *kind < 0x02 || *kind > 0x07) return std::nullopt;
  return static_cast<RecordKind>(*kind);
}

std::optional<uint32_t> RecordFields::number32(const std::string& name) const {
  return number<uint32_t>(name);
}

std::optional<uint64_t> RecordFields::number64(const std::string& name) const {
  return number<uint64_t>(name);
}

std::string RecordFields::text(const std::string& name) const {
  const auto field = fields_.find(name);
  if (field == fields_.end()) return {};
  return std::string(field->second.begin(), field->second.end());
}

std::optional<RecordView> recordAt(std::span<const uint8_t> bytes) {
  try {
    wire::Reader reader(bytes);
    const std::span<const uint8_t> head = reader.takeSized();
    std::optional<RecordFields> fields = RecordFields::parse(head);
    if (!fields) return std::nullopt;
    const std::optional<RecordKind> kind = fields->kind();
    if (!kind) return std::nullopt;
    const auto data_size = reader.take<uint32_t>();
    return RecordView{std::move(*fields), *kind, data_size, bytes.size() - reader.remaining()};
  } catch (const wire::Reader::CutOff&) {
    return std::nullopt;
  }
}

}  // namespace lodeline
