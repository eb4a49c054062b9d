#include "lodeline/io/logs/binary/dataflash.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

constexpr size_t kDataFlashHeader = 3;
constexpr std::array<uint8_t, 2> kMark = {0xA3, 0x95};
constexpr uint8_t kFormatType = 128;
constexpr size_t kNameSize = 4, kCodesSize = 16, kLabelsSize = 64;
constexpr size_t kFormatLength = kDataFlashHeader + 2 + kNameSize + kCodesSize + kLabelsSize;

/// Size and type of a code in a definition; no type for text and lists.
struct Code {
  char code;
  size_t size;
  std::optional<FieldType> type;
  double factor;
};
constexpr Code kCodes[] = {
    {'a', 64, std::nullopt, 1.0},      {'b', 1, FieldType::Int8, 1.0},    {'B', 1, FieldType::UInt8, 1.0},
    {'h', 2, FieldType::Int16, 1.0},   {'H', 2, FieldType::UInt16, 1.0},  {'i', 4, FieldType::Int32, 1.0},
    {'I', 4, FieldType::UInt32, 1.0},  {'f', 4, FieldType::Float, 1.0},   {'d', 8, FieldType::Double, 1.0},
    {'n', 4, std::nullopt, 1.0},       {'N', 16, std::nullopt, 1.0},      {'Z', 64, std::nullopt, 1.0},
    {'c', 2, FieldType::Int16, 1e-2},  {'C', 2, FieldType::UInt16, 1e-2}, {'e', 4, FieldType::Int32, 1e-2},
    {'E', 4, FieldType::UInt32, 1e-2}, {'L', 4, FieldType::Int32, 1e-7},  {'M', 1, FieldType::UInt8, 1.0},
    {'q', 8, FieldType::Int64, 1.0},   {'Q', 8, FieldType::UInt64, 1.0},  {'g', 2, std::nullopt, 1.0}};

const Code* codeOf(char code) {
  const auto found = std::find_if(std::begin(kCodes), std::end(kCodes),
                                  [&](const Code& known) { return known.code == code; });
  return found == std::end(kCodes) ? nullptr : found;
}

/// Text of a fixed size, which zeros fill at its end.
std::string_view textAt(std::span<const uint8_t> bytes, size_t offset, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()) + offset, size);
  return text.substr(0, text.find('\0'));
}

}  // namespace

DataFlash::DataFlash(std::unique_ptr<ByteSource> bytes, const std::string& file) : bytes_(std::move(bytes)) {
  const std::span<const uint8_t> head = bytes_.peek(kDataFlashHeader);
  if (head.size() < kDataFlashHeader || !std::equal(kMark.begin(), kMark.end(), head.begin())) {
    throw InputError(file + ": does not begin as a DataFlash log of ArduPilot; copy the file again");
  }
}

size_t DataFlash::lengthHere(std::span<const uint8_t> header) const {
  if (header.size() < kDataFlashHeader || !std::equal(kMark.begin(), kMark.end(), header.begin())) return 0;
  if (header[2] == kFormatType) return kFormatLength;
  return types_[header[2]] ? types_[header[2]]->length : 0;
}

void DataFlash::define(std::span<const uint8_t> payload) {
  auto type = std::make_unique<Type>();
  type->length = payload[1];
  type->format.topic = textAt(payload, 2, kNameSize);
  const std::string_view codes = textAt(payload, 2 + kNameSize, kCodesSize);
  std::string_view labels = textAt(payload, 2 + kNameSize + kCodesSize, kLabelsSize);
  size_t offset = 0;
  for (size_t i = 0; i < codes.size(); ++i) {
    const Code* code = codeOf(codes[i]);
    if (code == nullptr) return;
    const std::string_view label = labels.substr(0, labels.find(','));
    labels.remove_prefix(std::min(label.size() + 1, labels.size()));
    if (code->type) {
      type->format.fields.push_back({std::string(label), *code->type, offset, code->factor, ""});
      type->positions.push_back(i);
    }
    offset += code->size;
  }
  type->field_count = codes.size();
  // A definition whose length contradicts its fields is damaged.
  if (payload[0] == kFormatType || type->length != kDataFlashHeader + offset) return;
  // Logs without units have the instance in a field "I".
  const auto& fields = type->format.fields;
  const auto named = std::find_if(fields.begin(), fields.end(), [](const LogField& field) {
    return field.name == "I" || field.name == "Instance";
  });
  if (named != fields.end()) type->instance_field = static_cast<size_t>(named - fields.begin());
  types_[payload[0]] = std::move(type);
}

void DataFlash::takeUnit(std::span<const uint8_t> payload) {
  constexpr size_t kId = 8, kText = 9;
  if (payload.size() < kText + 64) return;
  units_[static_cast<char>(payload[kId])] = textAt(payload, kText, 64);
}

void DataFlash::takeMultiplier(std::span<const uint8_t> payload) {
  constexpr size_t kId = 8, kNumber = 9;
  if (payload.size() < kNumber + 8) return;
  multipliers_[static_cast<char>(payload[kId])] = littleEndian<double>(payload.subspan(kNumber));
}

void DataFlash::takeUnitsOfType(std::span<const uint8_t> payload) {
  constexpr size_t kType = 8, kUnits = 9, kMultipliers = 25;
  if (payload.size() < kMultipliers + 16 || !types_[payload[kType]]) return;
  Type& type = *types_[payload[kType]];
  for (size_t i = 0; i < type.format.fields.size(); ++i) {
    const auto unit_id = static_cast<char>(payload[kUnits + type.positions[i]]);
    const auto multiplier_id = static_cast<char>(payload[kMultipliers + type.positions[i]]);
    if (unit_id == '#') type.instance_field = i;
    const auto unit = units_.find(unit_id);
    if (unit != units_.end() && unit_id != '-' && unit_id != '?') type.format.fields[i].unit = unit->second;
    const auto multiplier = multipliers_.find(multiplier_id);
    const bool is_stated = multiplier != multipliers_.end() && multiplier_id != '-' && multiplier_id != '?';
    if (is_stated && multiplier->second != 0.0) type.format.fields[i].factor = multiplier->second;
  }
}

void DataFlash::resynchronize() {
  const uint64_t from = bytes_.position();
  do {
    bytes_.skip(1);
    if (!bytes_.find(kMark)) break;
  } while (lengthHere(bytes_.peek(kDataFlashHeader)) == 0);
  damage_.passOver(bytes_.position() - from);
}

bool DataFlash::next(LogMessage* message) {
  bytes_.skip(unread_);
  unread_ = 0;
  while (true) {
    const std::span<const uint8_t> header = bytes_.peek(kDataFlashHeader);
    if (header.empty()) return false;
    const size_t length = lengthHere(header);
    if (length == 0 && header.size() == kDataFlashHeader) {
      resynchronize();
      continue;
    }
    const std::span<const uint8_t> whole = bytes_.peek(std::max(length, kDataFlashHeader));
    if (length == 0 || whole.size() < length) {
      damage_.is_cut_off = true;
      return false;
    }
    const std::span<const uint8_t> payload = whole.subspan(kDataFlashHeader, length - kDataFlashHeader);
    const uint8_t number = whole[2];
    if (number == kFormatType) {
      define(payload);
      bytes_.skip(length);
      continue;
    }
    const Type& type = *types_[number];
    if (type.format.topic == "UNIT") takeUnit(payload);
    if (type.format.topic == "MULT") takeMultiplier(payload);
    if (type.format.topic == "FMTU") takeUnitsOfType(payload);
    *message = {&type.format, 0, payload};
    if (type.instance_field) {
      const LogField& field = type.format.fields[*type.instance_field];
      message->instance = static_cast<int>(message->count(field).value_or(0));
    }
    unread_ = length;
    return true;
  }
}

}  // namespace lodeline
