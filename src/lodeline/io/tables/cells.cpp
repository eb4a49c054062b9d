#include "lodeline/io/tables/cells.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdlib>

namespace lodeline {
namespace {

constexpr std::string_view kMinusSign = "\u2212";  // typographic minus sign

/// Calls `visit(position)` for each character outside of quotes, until it returns false.
template <typename Visit>
void outsideQuotes(std::string_view line, Visit visit) {
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') is_quoted = !is_quoted;
    if (!is_quoted && line[i] != '"' && !visit(i)) return;
  }
}

/// Whether each comma is a decimal comma within a word, as in "0,25 12,812 -7,0".
bool hasDecimalCommasBetweenBlanks(std::string_view line) {
  int words = 0, with_comma = 0;
  for (std::size_t begin = line.find_first_not_of(' '); begin != std::string_view::npos;) {
    const std::size_t end = std::min(line.find(' ', begin), line.size());
    const std::string_view word = line.substr(begin, end - begin);
    begin = line.find_first_not_of(' ', end);
    ++words;
    const std::size_t comma = word.find(',');
    if (comma == std::string_view::npos) continue;
    ++with_comma;
    const bool is_decimal = comma > 0 && comma + 1 < word.size() && isDigit(word[comma - 1]) &&
                            isDigit(word[comma + 1]) &&
                            word.find_first_of(",.", comma + 1) == std::string_view::npos;
    if (!is_decimal || word.find('.') < comma) return false;
  }
  return words >= 3 && with_comma >= 1;
}

char characterOf(Separator separator) {
  return separator == Separator::Semicolon ? ';' : separator == Separator::Tab ? '\t' : ',';
}

/// Whether blanks as well as commas separate numbers, as in "0.5 1,2,3".
bool hasNumbersBetweenBlanks(std::string_view line) {
  std::vector<std::string_view> cells;
  std::vector<std::string> unquoted;
  splitCells(line, Separator::Comma, &cells, &unquoted);
  const auto hasBlank = [](std::string_view cell) { return cell.find(' ') != std::string_view::npos; };
  if (std::none_of(cells.begin(), cells.end(), hasBlank)) return false;
  splitCells(line, Separator::CommasAndBlanks, &cells, &unquoted);
  return std::all_of(cells.begin(), cells.end(),
                     [](std::string_view cell) { return numberFrom(cell).has_value(); });
}

bool isBlank(char c) { return c == ' ' || c == '\t'; }

/// The end of the quoted part of a cell that starts at `begin`; the size of the line where the quote is not
/// closed.
std::size_t endOfQuotes(std::string_view line, std::size_t begin) {
  for (std::size_t i = begin + 1; i < line.size(); ++i) {
    if (line[i] != '"') continue;
    if (i + 1 < line.size() && line[i + 1] == '"') {
      ++i;
    } else {
      return i;
    }
  }
  return line.size();
}

/// The end of the run of blanks at `at`: its last blank, or the mark after it.
std::size_t skipBlanksBeforeMark(std::string_view line, std::size_t at, char mark) {
  const std::size_t next = line.find_first_not_of(" \t", at);
  if (next == std::string_view::npos) return line.size();
  return line[next] == mark || next == at ? next : next - 1;
}

std::string withoutQuotes(std::string_view cell) {
  std::string text;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    if (cell[i] != '"') {
      text += cell[i];
    } else if (i + 1 < cell.size() && cell[i + 1] == '"' && i > 0) {
      text += cell[++i];
    }
  }
  return text;
}

std::string_view unquotedCell(std::string_view cell, std::vector<std::string>* unquoted) {
  cell = trimmed(cell);
  if (cell.size() >= 2 && cell.front() == '"' && cell.find('"', 1) == cell.size() - 1) {
    return trimmed(cell.substr(1, cell.size() - 2));
  }
  if (cell.empty() || cell.front() != '"') return cell;
  unquoted->push_back(withoutQuotes(cell));
  return trimmed(unquoted->back());
}

/// A number with commas, rewritten with a decimal point and without groups of thousands; empty where the
/// marks do not form a number.
std::string withoutCommas(std::string_view cell) {
  const std::size_t comma = cell.rfind(','), point = cell.rfind('.');
  std::string text(cell);
  if (point == std::string_view::npos) {
    if (cell.find(',') != comma) return {};  // a list, or groups of thousands of a whole number
    text[comma] = '.';
    return text;
  }
  const char group = comma < point ? ',' : '.';
  for (std::size_t at = cell.find(group); at < std::max(comma, point); at = cell.find(group, at + 1)) {
    if (cell.find_first_of(",.", at + 1) != at + 4) return {};
  }
  std::erase(text, group);
  std::replace(text.begin(), text.end(), ',', '.');
  return text;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kNoBreak = "\u00a0";
  while (!text.empty()) {
    if (isBlank(text.front()) || text.front() == '\r') {
      text.remove_prefix(1);
    } else if (isBlank(text.back()) || text.back() == '\r') {
      text.remove_suffix(1);
    } else if (text.starts_with(kNoBreak)) {
      text.remove_prefix(kNoBreak.size());
    } else if (text.ends_with(kNoBreak)) {
      text.remove_suffix(kNoBreak.size());
    } else {
      break;
    }
  }
  return text;
}

Separator separatorOf(std::string_view line) {
  bool has_semicolon = false, has_tab = false, has_comma = false;
  line = trimmed(line);
  outsideQuotes(line, [&](std::size_t i) {
    has_semicolon = has_semicolon || line[i] == ';';
    has_comma = has_comma || line[i] == ',';
    // A tab after a comma is only alignment.
    has_tab = has_tab || (line[i] == '\t' && (i == 0 || line[i - 1] != ','));
    return !has_semicolon;
  });
  if (has_semicolon) return Separator::Semicolon;
  if (has_tab) return Separator::Tab;
  if (!has_comma || hasDecimalCommasBetweenBlanks(line)) return Separator::Blanks;
  return hasNumbersBetweenBlanks(line) ? Separator::CommasAndBlanks : Separator::Comma;
}

void splitCells(std::string_view line, Separator separator, std::vector<std::string_view>* cells,
                std::vector<std::string>* unquoted) {
  cells->clear();
  unquoted->clear();
  // The views into the strings must stay valid; there are never more strings than quotes.
  unquoted->reserve(static_cast<std::size_t>(std::count(line.begin(), line.end(), '"')));
  const bool by_blanks = separator == Separator::Blanks;
  const bool ends_at_blank = separator == Separator::CommasAndBlanks;
  const char mark = characterOf(separator);
  std::size_t begin = 0;
  while (true) {
    const auto is_skipped = [&](char c) { return by_blanks ? isBlank(c) : isBlank(c) && c != mark; };
    while (begin < line.size() && is_skipped(line[begin])) ++begin;
    if (by_blanks && begin >= line.size()) return;
    std::size_t end = begin;
    if (begin < line.size() && line[begin] == '"') end = endOfQuotes(line, begin);
    const auto ends = [&](char c) {
      return by_blanks ? isBlank(c) : c == mark || (ends_at_blank && isBlank(c));
    };
    while (end < line.size() && !ends(line[end])) ++end;
    cells->push_back(unquotedCell(line.substr(begin, end - begin), unquoted));
    if (ends_at_blank) end = skipBlanksBeforeMark(line, end, mark);
    if (end >= line.size()) return;
    begin = end + 1;
  }
}

std::optional<double> numberFrom(std::string_view cell) {
  if (cell.find(',') != std::string_view::npos || cell.starts_with(kMinusSign)) {
    const std::string plain = withDecimalPoint(cell);
    return plain == cell ? std::nullopt : numberFrom(plain);
  }
  if (cell.starts_with('+')) cell.remove_prefix(1);
  double number = 0.0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  if (cell.empty() || end != cell.data() + cell.size()) return std::nullopt;
  // Beyond the range of a double: zero or infinity.
  if (error == std::errc::result_out_of_range) return std::strtod(std::string(cell).c_str(), nullptr);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

std::string withDecimalPoint(std::string_view cell) {
  const bool is_negative = cell.starts_with(kMinusSign);
  std::string text(is_negative ? cell.substr(kMinusSign.size()) : cell);
  if (text.find(',') != std::string::npos) text = withoutCommas(text);
  if (text.empty()) return std::string(cell);
  return is_negative ? "-" + text : text;
}

}  // namespace lodeline
