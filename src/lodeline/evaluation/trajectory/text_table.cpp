#include "lodeline/evaluation/trajectory/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>

#include "lodeline/diagnostics.h"
#include "lodeline/io/tables/text_lines.h"

namespace lodeline {
namespace {

std::vector<std::string> splitFields(std::string_view line) {
  std::vector<std::string> fields;
  const char* separators = " \t,;\r";
  std::size_t begin = line.find_first_not_of(separators);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    fields.emplace_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(separators, end);
  }
  return fields;
}

bool parseNumber(const std::string& text, double& value) {
  char* end = nullptr;
  value = std::strtod(text.c_str(), &end);
  return end != text.c_str() && *end == '\0';
}

}  // namespace

std::string TextTable::where(const TextLine& line) const {
  return fmt::format("{}:{}", path.string(), line.number);
}

double TextTable::number(const TextLine& line, std::size_t column) const {
  double value = 0.0;
  if (!parseNumber(line.fields.at(column), value)) {
    throw InputError(fmt::format("{}: column {} is '{}', expected a number", where(line), column + 1,
                                 line.fields[column]));
  }
  return value;
}

Time TextTable::timeInSeconds(const TextLine& line, std::size_t column) const {
  Time time;
  if (!parseSeconds(line.fields.at(column), time)) {
    throw InputError(fmt::format("{}: column {} is '{}', expected a time in seconds", where(line), column + 1,
                                 line.fields[column]));
  }
  return time;
}

Time TextTable::timeInNanoseconds(const TextLine& line, std::size_t column) const {
  const std::string& text = line.fields.at(column);
  if (!isInteger(text) || text.size() > 18 + (text[0] == '1')) {
    throw InputError(fmt::format("{}: column {} is '{}', expected a time in whole nanoseconds", where(line),
                                 column + 1, text));
  }
  return Time::fromNanoseconds(std::strtoll(text.c_str(), nullptr, 10));
}

std::string readFileBytes(const std::filesystem::path& path) {
  const std::unique_ptr<ByteSource> source = openFile(path);
  std::string bytes;
  std::vector<char> buffer(1 << 18);
  for (std::size_t count = 0; (count = source->read(buffer.data(), buffer.size())) > 0;) {
    bytes.append(buffer.data(), count);
  }
  return bytes;
}

TextTable readTextTable(const std::filesystem::path& path) {
  TextTable table;
  table.path = path;
  TextLines lines(openFile(path), path.string());
  for (std::string_view text; lines.next(&text);) {
    std::vector<std::string> fields = splitFields(text);
    if (fields.empty() || fields.front().front() == '#') continue;
    table.lines.push_back({lines.number(), std::move(fields)});
  }
  if (table.lines.empty()) throw InputError(fmt::format("{}: holds no data lines", path.string()));
  return table;
}

bool parseSeconds(std::string_view text, Time& time) {
  // A double resolves present Unix times to 0.2 us only; a long double resolves less than a nanosecond.
  const std::string copy(text);
  char* end = nullptr;
  const long double seconds = std::strtold(copy.c_str(), &end);
  if (end == copy.c_str() || *end != '\0' || !(std::fabs(seconds) < 9.2e9L)) return false;
  time = Time::fromNanoseconds(std::llround(seconds * 1e9L));
  return true;
}

bool isInteger(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace lodeline
