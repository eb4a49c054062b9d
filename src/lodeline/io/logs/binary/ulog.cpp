#include "lodeline/io/logs/binary/ulog.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

constexpr size_t kULogHeaderSize = 16, kULogMessageHeader = 3;
constexpr std::array<uint8_t, 7> kMagic = {'U', 'L', 'o', 'g', 0x01, 0x12, 0x35};
/// A synchronization message with its header.
constexpr std::array<uint8_t, 11> kSync = {0x08, 0x00, 'S', 0x2F, 0x73, 0x13, 0x20, 0x25, 0x0C, 0xBB, 0x12};
constexpr std::string_view kTypes = "BFIMPQARDLCSO";
constexpr int kDeepestNesting = 8;
constexpr size_t kMostFields = 4096;

std::string_view textOf(std::span<const uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Type of a number; empty for text and for names of other definitions.
std::optional<FieldType> numberType(std::string_view name) {
  constexpr std::pair<std::string_view, FieldType> kNumbers[] = {
      {"int8_t", FieldType::Int8},     {"uint8_t", FieldType::UInt8},   {"int16_t", FieldType::Int16},
      {"uint16_t", FieldType::UInt16}, {"int32_t", FieldType::Int32},   {"uint32_t", FieldType::UInt32},
      {"int64_t", FieldType::Int64},   {"uint64_t", FieldType::UInt64}, {"float", FieldType::Float},
      {"double", FieldType::Double},   {"bool", FieldType::UInt8},      {"char", FieldType::UInt8}};
  for (const auto& [known, type] : kNumbers) {
    if (known == name) return type;
  }
  return std::nullopt;
}

}  // namespace

ULog::ULog(std::unique_ptr<ByteSource> bytes, std::string file)
    : bytes_(std::move(bytes)), file_(std::move(file)) {
  readHeader();
}

void ULog::readHeader() {
  const std::span<const uint8_t> header = bytes_.peek(kULogHeaderSize);
  if (header.size() < kULogHeaderSize || !std::equal(kMagic.begin(), kMagic.end(), header.begin())) {
    throw InputError(file_ + ": no complete header of a ULog file; copy the file again");
  }
  bytes_.skip(kULogHeaderSize);
}

void ULog::takeFlags(std::span<const uint8_t> payload) {
  constexpr size_t kFlags = 8, kOffsets = 3;
  constexpr uint8_t kDataAppended = 1;
  if (payload.size() < 2 * kFlags + 8 * kOffsets) return;
  const std::span<const uint8_t> incompatible = payload.subspan(kFlags, kFlags);
  const bool has_unknown =
      (incompatible[0] & ~kDataAppended) != 0 ||
      std::any_of(incompatible.begin() + 1, incompatible.end(), [](uint8_t byte) { return byte != 0; });
  if (has_unknown) {
    throw InputError(file_ +
                     ": a ULog file with features that are not known here; write its readings as "
                     "CSV (ulog2csv)");
  }
  if ((incompatible[0] & kDataAppended) == 0) return;
  for (size_t i = 0; i < kOffsets; ++i) {
    const auto offset = littleEndian<uint64_t>(payload.subspan(2 * kFlags + 8 * i));
    if (offset > bytes_.position()) appended_.push_back(offset);
  }
  std::sort(appended_.begin(), appended_.end());
}

void ULog::define(std::string_view text) {
  const size_t colon = text.find(':');
  if (colon == std::string_view::npos) return;
  definitions_[std::string(text.substr(0, colon))] = text.substr(colon + 1);
}

bool ULog::addField(std::string_view type_and_name, const std::string& prefix, int depth, size_t* offset,
                    std::vector<LogField>* fields) const {
  const size_t blank = type_and_name.find(' ');
  if (blank == std::string_view::npos) return false;
  std::string_view type = type_and_name.substr(0, blank);
  const std::string name = prefix + std::string(type_and_name.substr(blank + 1));
  size_t count = 1;
  const size_t bracket = type.find('[');
  const bool is_array = bracket != std::string_view::npos;
  if (is_array) {
    const auto [end, error] = std::from_chars(type.data() + bracket + 1, type.data() + type.size(), count);
    if (error != std::errc() || end == type.data() + type.size() || *end != ']') return false;
    type = type.substr(0, bracket);
  }
  if (count > std::numeric_limits<uint16_t>::max()) return false;
  const std::optional<FieldType> number = numberType(type);
  if (type == "char") {
    *offset += count;
    return true;
  }
  for (size_t i = 0; i < count; ++i) {
    const std::string indexed = is_array ? fmt::format("{}[{}]", name, i) : name;
    if (!number) {
      if (!addFields(std::string(type), indexed + ".", depth + 1, offset, fields)) return false;
      continue;
    }
    if (fields->size() >= kMostFields) return false;
    fields->push_back({indexed, *number, *offset, 1.0, ""});
    *offset += sizeOf(*number);
  }
  return *offset <= std::numeric_limits<uint16_t>::max();
}

bool ULog::addFields(const std::string& definition, const std::string& prefix, int depth, size_t* offset,
                     std::vector<LogField>* fields) const {
  const auto found = definitions_.find(definition);
  if (found == definitions_.end() || depth > kDeepestNesting) return false;
  std::string_view rest = found->second;
  while (!rest.empty()) {
    const size_t end = std::min(rest.find(';'), rest.size());
    if (end > 0 && !addField(rest.substr(0, end), prefix, depth, offset, fields)) return false;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return true;
}

void ULog::subscribe(std::span<const uint8_t> payload) {
  if (payload.size() < 4) return;
  Subscription subscription;
  subscription.instance = payload[0];
  const auto id = littleEndian<uint16_t>(payload.subspan(1));
  subscription.format.topic = textOf(payload.subspan(3));
  size_t offset = 0;
  if (addFields(subscription.format.topic, "", 0, &offset, &subscription.format.fields)) {
    subscriptions_[id] = std::move(subscription);
  } else {
    subscriptions_.erase(id);
  }
}

uint64_t ULog::bytesToAppended() const {
  return appended_.empty() ? std::numeric_limits<uint64_t>::max() : appended_.front() - bytes_.position();
}

/// Types that are not known are from a later version, and are skipped, where a known type follows.
bool ULog::isDamagedHere(size_t size, char type) {
  if (size == 0) return true;
  if (kTypes.find(type) != std::string_view::npos) return false;
  const size_t whole = kULogMessageHeader + size;
  const std::span<const uint8_t> view = bytes_.peek(whole + kULogMessageHeader);
  return view.size() < whole + kULogMessageHeader ||
         kTypes.find(static_cast<char>(view[whole + 2])) == std::string_view::npos;
}

void ULog::resynchronize() {
  const uint64_t from = bytes_.position();
  bytes_.skip(1);
  bytes_.find(kSync);
  while (!appended_.empty() && appended_.front() <= bytes_.position()) appended_.erase(appended_.begin());
  damage_.passOver(bytes_.position() - from);
}

bool ULog::next(LogMessage* message) {
  bytes_.skip(unread_);
  unread_ = 0;
  while (true) {
    const std::span<const uint8_t> header = bytes_.peek(kULogMessageHeader);
    if (header.empty()) return false;
    const size_t size = header.size() < kULogMessageHeader ? 0 : littleEndian<uint16_t>(header);
    const char type = header.size() < kULogMessageHeader ? '\0' : static_cast<char>(header[2]);
    const bool ends_before_appended = bytesToAppended() < kULogMessageHeader + size;
    if (bytesToAppended() == 0 || ends_before_appended) {
      bytes_.skip(static_cast<size_t>(bytesToAppended()));
      appended_.erase(appended_.begin());
      continue;
    }
    if (header.size() == kULogMessageHeader && isDamagedHere(size, type)) {
      resynchronize();
      continue;
    }
    const std::span<const uint8_t> whole = bytes_.peek(kULogMessageHeader + size);
    if (whole.size() < kULogMessageHeader + size || header.size() < kULogMessageHeader) {
      damage_.is_cut_off = true;
      return false;
    }
    const std::span<const uint8_t> payload = whole.subspan(kULogMessageHeader);
    if (type == 'B') takeFlags(payload);
    if (type == 'F') define(textOf(payload));
    if (type == 'A') subscribe(payload);
    if (type == 'R' && size >= 2) subscriptions_.erase(littleEndian<uint16_t>(payload));
    if (type == 'D' && size >= 2) {
      const auto topic = subscriptions_.find(littleEndian<uint16_t>(payload));
      if (topic != subscriptions_.end()) {
        unread_ = kULogMessageHeader + size;
        *message = {&topic->second.format, topic->second.instance, payload.subspan(2)};
        return true;
      }
    }
    bytes_.skip(kULogMessageHeader + size);
  }
}

}  // namespace lodeline
