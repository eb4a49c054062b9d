#include "lodeline/io/logs/binary/message_log.h"

#include <algorithm>

#include "lodeline/io/logs/binary/log_bytes.h"

namespace lodeline {

size_t sizeOf(FieldType type) {
  constexpr size_t kSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<size_t>(type)];
}

const LogField* LogFormat::field(std::string_view name) const {
  const auto found =
      std::find_if(fields.begin(), fields.end(), [&](const LogField& field) { return field.name == name; });
  return found == fields.end() ? nullptr : &*found;
}

std::optional<int64_t> LogMessage::count(const LogField& field) const {
  const size_t size = sizeOf(field.type);
  if (field.offset > payload.size() || payload.size() - field.offset < size) return std::nullopt;
  const std::span<const uint8_t> bytes = payload.subspan(field.offset, size);
  switch (field.type) {
    case FieldType::Int8:
      return littleEndian<int8_t>(bytes);
    case FieldType::UInt8:
      return bytes[0];
    case FieldType::Int16:
      return littleEndian<int16_t>(bytes);
    case FieldType::UInt16:
      return littleEndian<uint16_t>(bytes);
    case FieldType::Int32:
      return littleEndian<int32_t>(bytes);
    case FieldType::UInt32:
      return littleEndian<uint32_t>(bytes);
    case FieldType::Int64:
    case FieldType::UInt64:
      return littleEndian<int64_t>(bytes);
    default:
      return std::nullopt;
  }
}

std::optional<double> LogMessage::value(const LogField& field) const {
  if (const std::optional<int64_t> number = count(field)) return field.factor * static_cast<double>(*number);
  const size_t size = sizeOf(field.type);
  if (field.offset > payload.size() || payload.size() - field.offset < size) return std::nullopt;
  const std::span<const uint8_t> bytes = payload.subspan(field.offset, size);
  if (field.type == FieldType::Float) return field.factor * static_cast<double>(littleEndian<float>(bytes));
  return field.factor * littleEndian<double>(bytes);
}

}  // namespace lodeline
