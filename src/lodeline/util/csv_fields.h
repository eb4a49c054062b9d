#pragma once

#include <charconv>
#include <string_view>
#include <vector>

/// Functions that parse one line of a comma-separated file.
namespace lodeline::csv {

/// `text` without blanks, tabs and carriage returns at both ends.
inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r";
  const size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

/// Splits a line at its commas into trimmed fields.
inline void split(std::string_view line, std::vector<std::string_view>* fields) {
  fields->clear();
  size_t begin = 0;
  for (size_t comma = line.find(','); comma != std::string_view::npos; comma = line.find(',', begin)) {
    fields->push_back(trimmed(line.substr(begin, comma - begin)));
    begin = comma + 1;
  }
  fields->push_back(trimmed(line.substr(begin)));
  // A comma at the end of a row ends the last field. It does not start another one.
  if (fields->size() > 1 && fields->back().empty()) fields->pop_back();
}

/// Parses all of `text` as one number. Returns false where `text` is anything else.
template <typename Number>
bool parse(std::string_view text, Number* number) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), *number);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace lodeline::csv
