#include "lodeline/io/tables/column_name.h"

#include <algorithm>
#include <cctype>

#include "lodeline/io/tables/cells.h"

namespace lodeline {
namespace {

bool isLetter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) >= 0x80;
}
bool isUpper(char c) { return c >= 'A' && c <= 'Z'; }

/// Latin-1 letters as lower case ASCII; other characters unchanged.
std::string lower(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (static_cast<unsigned char>(text[i]) == 0xC3 && i + 1 < text.size()) {
      // U+00C0 to U+00FF: capital and small letters differ by 0x20.
      const auto low = static_cast<unsigned char>(static_cast<unsigned char>(text[++i]) | 0x20);
      result += low == 0xA9 || low == 0xA8 || low == 0xAA || low == 0xAB ? 'e'
                : low >= 0xA0 && low <= 0xA5                             ? 'a'
                : low >= 0xAC && low <= 0xAF                             ? 'i'
                : (low >= 0xB2 && low <= 0xB6) || low == 0xB8            ? 'o'
                : low >= 0xB9 && low <= 0xBC                             ? 'u'
                : low == 0xA7                                            ? 'c'
                : low == 0xB1                                            ? 'n'
                                                                         : '?';
    } else {
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(text[i])));
    }
  }
  return result;
}

/// Whether a word ends between `text[i - 1]` and `text[i]`: "Gyr|X", "mag|1", "TimeUS" as "Time|US".
bool isWordBoundary(std::string_view text, std::size_t i) {
  const char before = text[i - 1], here = text[i];
  if (isUpper(here) && isLetter(before) && !isUpper(before)) return true;
  // The last of several capitals starts the next word: "IMUGyro" as "IMU|Gyro".
  if (isUpper(before) && isLetter(here) && !isUpper(here) && i >= 2 && isUpper(text[i - 2])) {
    return true;
  }
  return isDigit(here) != isDigit(before) && isLetter(here) != isLetter(before);
}

/// Calls `word(begin, end)` for each word of the name.
template <typename Word>
void forEachWord(std::string_view name, Word word) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i <= name.size(); ++i) {
    const bool is_inside = i < name.size() && (isLetter(name[i]) || isDigit(name[i]));
    const bool is_boundary = !is_inside || (i > begin && isWordBoundary(name, i));
    if (!is_boundary) continue;
    if (i > begin) word(begin, i);
    begin = is_inside ? i : i + 1;
  }
}

/// The part in the last pair of brackets, unless it is an index or a channel's number ("[0]", "[x8006]").
std::string takeUnit(std::string* name) {
  const std::size_t open = name->find_last_of("[(");
  if (open == std::string::npos) return {};
  const std::size_t close = name->find_first_of("])", open);
  std::string inside(trimmed(std::string_view(*name).substr(
      open + 1, close == std::string::npos ? std::string::npos : close - open - 1)));
  const bool is_index = !inside.empty() && std::all_of(inside.begin(), inside.end(), isDigit);
  if (is_index) return {};
  const std::size_t end = close == std::string::npos ? name->size() : close + 1;
  name->erase(open, end - open);
  const bool is_channel = inside.size() >= 2 && (inside[0] == 'x' || inside[0] == '#') &&
                          std::all_of(inside.begin() + 1, inside.end(), [](char c) {
                            return std::isxdigit(static_cast<unsigned char>(c)) != 0;
                          });
  return is_channel ? std::string() : inside;
}

/// The name without an index or axis letter at the end: "gyro_rad[0]", "field_nT_x".
std::string_view withoutAxis(std::string_view name) {
  name = trimmed(name);
  if (name.ends_with(']')) name = name.substr(0, name.find_last_of('['));
  const bool has_axis =
      name.size() >= 3 && std::string_view("xyzXYZ").find(name.back()) != std::string_view::npos;
  if (has_axis && std::string_view("_ .-").find(name[name.size() - 2]) != std::string_view::npos) {
    name.remove_suffix(2);
  }
  return name;
}

/// Possible unit suffixes of a name. "nT" and "uT" are split by their case, "m_s2" by its digit and
/// separator.
std::vector<std::string> suffixesOf(std::string_view name) {
  std::vector<std::string> words, suffixes;
  forEachWord(name, [&](std::size_t begin, std::size_t end) {
    words.push_back(lower(name.substr(begin, end - begin)));
  });
  const std::size_t count = words.size();
  if (count < 2) return {};
  if (count >= 4 && words.back() == "2") suffixes.push_back(words[count - 3] + "/" + words[count - 2] + "2");
  const std::size_t separator = name.find_last_of("_ .-/");
  if (separator != std::string_view::npos) suffixes.emplace_back(name.substr(separator + 1));
  if (count >= 3) suffixes.push_back(words[count - 2] + "/" + words.back());
  suffixes.push_back(words.back());
  return suffixes;
}

}  // namespace

ColumnName::ColumnName(std::string_view header) : text(trimmed(header)) {
  std::string name = text;
  unit = takeUnit(&name);
  std::vector<std::string_view> parts;
  forEachWord(name, [&](std::size_t begin, std::size_t end) {
    parts.push_back(std::string_view(name).substr(begin, end - begin));
    words.push_back(lower(parts.back()));
  });
  if (unit.empty() && words.size() >= 2 && words[words.size() - 2] == "in") {
    unit = parts.back();
    words.resize(words.size() - 2);
  }
  if (unit.empty()) suffixes = suffixesOf(withoutAxis(name));
}

bool ColumnName::hasWord(std::initializer_list<std::string_view> wanted) const {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::find(wanted.begin(), wanted.end(), word) != wanted.end();
  });
}

bool ColumnName::hasStem(std::initializer_list<std::string_view> stems) const {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::any_of(stems.begin(), stems.end(),
                       [&](std::string_view stem) { return word.starts_with(stem); });
  });
}

}  // namespace lodeline
