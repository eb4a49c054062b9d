#include "lodeline/io/video/gpmf/klv_reader.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstring>
#include <limits>
#include <type_traits>

#include "lodeline/io/tables/text_lines.h"

namespace lodeline::gpmf {
namespace {

constexpr size_t kHeaderBytes = 8;
constexpr size_t kAlignment = 4;
constexpr size_t kGreatestSample = 255;

bool isKey(std::span<const uint8_t> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](uint8_t c) { return std::isprint(c) != 0; });
}

template <typename Number>
double bigEndian(const uint8_t* bytes) {
  using Bits =
      std::conditional_t<sizeof(Number) == 1, uint8_t,
                         std::conditional_t<sizeof(Number) == 2, uint16_t,
                                            std::conditional_t<sizeof(Number) == 4, uint32_t, uint64_t>>>;
  uint64_t bits = 0;
  for (size_t i = 0; i < sizeof(Number); ++i) bits = bits << 8 | bytes[i];
  return static_cast<double>(std::bit_cast<Number>(static_cast<Bits>(bits)));
}

double numberOf(char type, const uint8_t* bytes) {
  switch (type) {
    case 'b':
      return bigEndian<int8_t>(bytes);
    case 'B':
      return bigEndian<uint8_t>(bytes);
    case 's':
      return bigEndian<int16_t>(bytes);
    case 'S':
      return bigEndian<uint16_t>(bytes);
    case 'l':
      return bigEndian<int32_t>(bytes);
    case 'L':
      return bigEndian<uint32_t>(bytes);
    case 'j':
      return bigEndian<int64_t>(bytes);
    case 'J':
      return bigEndian<uint64_t>(bytes);
    case 'f':
      return bigEndian<float>(bytes);
    case 'd':
      return bigEndian<double>(bytes);
    case 'q':
      return bigEndian<int32_t>(bytes) / 65536.0;
    case 'Q':
      return bigEndian<int64_t>(bytes) / 4294967296.0;
    default:
      return std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace

std::optional<Element> ElementReader::next() {
  if (rest_.empty()) return std::nullopt;
  const bool is_filling = std::all_of(rest_.begin(), rest_.begin() + std::min(rest_.size(), kAlignment),
                                      [](uint8_t c) { return c == 0; });
  if (is_filling) {
    rest_ = {};
    return std::nullopt;
  }
  const auto stop = [this](std::string problem) {
    problem_ = std::move(problem);
    rest_ = {};
    return std::nullopt;
  };
  if (rest_.size() < kHeaderBytes) return stop(fmt::format("{} bytes after the last element", rest_.size()));
  if (!isKey(rest_.first(4))) return stop("an element without a readable key");
  Element element;
  element.key.assign(rest_.begin(), rest_.begin() + 4);
  element.type = static_cast<char>(rest_[4]);
  element.size = rest_[5];
  element.repeats = static_cast<uint16_t>(rest_[6] << 8 | rest_[7]);
  const size_t length = size_t{element.size} * element.repeats;
  if (length > rest_.size() - kHeaderBytes) {
    return stop(fmt::format("element {} of {} bytes in the last {}", element.key, length,
                            rest_.size() - kHeaderBytes));
  }
  element.bytes = rest_.subspan(kHeaderBytes, length);
  const size_t padded = (length + kAlignment - 1) / kAlignment * kAlignment;
  rest_ = rest_.subspan(std::min(rest_.size(), kHeaderBytes + padded));
  return element;
}

std::optional<size_t> sizeOf(char type) {
  switch (type) {
    case 'b':
    case 'B':
    case 'c':
      return 1;
    case 's':
    case 'S':
      return 2;
    case 'l':
    case 'L':
    case 'f':
    case 'F':
    case 'q':
      return 4;
    case 'j':
    case 'J':
    case 'd':
    case 'Q':
      return 8;
    case 'G':
    case 'U':
      return 16;
    default:
      return std::nullopt;
  }
}

std::string expandedTypes(const std::string& text) {
  std::string types;
  for (size_t i = 0; i < text.size() && text[i] != '\0'; ++i) {
    if (text[i] != '[') {
      if (!sizeOf(text[i])) return {};
      types += text[i];
    } else {
      const size_t close = text.find(']', i);
      if (types.empty() || close == std::string::npos || close == i + 1 || close > i + 4) return {};
      size_t count = 0;
      for (size_t digit = i + 1; digit < close; ++digit) {
        if (std::isdigit(static_cast<unsigned char>(text[digit])) == 0) return {};
        count = 10 * count + static_cast<size_t>(text[digit] - '0');
      }
      if (count == 0 || count > kGreatestSample) return {};
      types.append(count - 1, types.back());
      i = close;
    }
    if (types.size() > kGreatestSample) return {};
  }
  return types;
}

std::optional<std::vector<double>> numbersOf(const Element& element, const std::string& types) {
  std::string fields = types;
  if (element.type != '?') {
    const std::optional<size_t> size = sizeOf(element.type);
    if (!size || element.size == 0 || element.size % *size != 0) return std::nullopt;
    fields.assign(element.size / *size, element.type);
  }
  size_t sample_bytes = 0;
  for (const char type : fields) sample_bytes += sizeOf(type).value_or(0);
  if (fields.empty() || sample_bytes != element.size) return std::nullopt;
  std::vector<double> numbers;
  numbers.reserve(fields.size() * element.repeats);
  const uint8_t* at = element.bytes.data();
  for (size_t sample = 0; sample < element.repeats; ++sample) {
    for (const char type : fields) {
      numbers.push_back(numberOf(type, at));
      at += *sizeOf(type);
    }
  }
  return numbers;
}

std::string textOf(const Element& element) {
  std::string text(element.bytes.begin(), element.bytes.end());
  text.resize(text.find_last_not_of('\0') + 1);
  return fromLatin1(text);
}

}  // namespace lodeline::gpmf
