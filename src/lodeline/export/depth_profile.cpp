#include "lodeline/export/depth_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <optional>
#include <utility>

#include "lodeline/base/csv_fields.h"
#include "lodeline/base/error.h"
#include "lodeline/export/profile_time.h"

namespace lodeline {
namespace {

constexpr double kMetresPerFoot = 0.3048;

/// How a file's rows are to be read.
struct Layout {
  char separator = ',';
  size_t time_column = 0;
  size_t depth_column = 1;
  double seconds_per_unit = 0.0;  ///< 0: by the size of the first number
  double metres_per_unit = 1.0;
};

std::string lowered(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return result;
}

/// The commonest of the three separators; commas are decimal where there are semicolons.
char separatorOf(const std::string& line) {
  for (char separator : {';', '\t'}) {
    if (line.find(separator) != std::string::npos) return separator;
  }
  return ',';
}

/// Fields as a comma-separated line would have them, with a decimal point.
std::vector<std::string> fieldsOf(std::string line, char separator) {
  if (separator == ';') std::replace(line.begin(), line.end(), ',', '.');
  std::replace(line.begin(), line.end(), separator, ',');
  std::erase(line, '"');
  std::vector<std::string_view> views;
  csv::split(line, &views);
  return {views.begin(), views.end()};
}

/// The words of a column's name: "Depth (ft)" has "depth" and "ft".
std::vector<std::string> wordsOf(const std::string& name) {
  std::vector<std::string> words(1);
  for (char c : lowered(name)) {
    if (std::isalpha(static_cast<unsigned char>(c))) {
      words.back() += c;
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  return words;
}

bool hasWord(const std::vector<std::string>& words, std::initializer_list<const char*> wanted) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::find(wanted.begin(), wanted.end(), word) != wanted.end();
  });
}

/// The first column whose name has all words of a set; sets earlier in the list go first. Logs of dive
/// planners have the time of the dive's start and the greatest depth beside those of each sample.
std::optional<size_t> firstColumn(const std::vector<std::string>& names,
                                  const std::vector<std::vector<const char*>>& sets) {
  for (const std::vector<const char*>& set : sets) {
    for (size_t i = 0; i < names.size(); ++i) {
      const std::vector<std::string> words = wordsOf(names[i]);
      if (std::all_of(set.begin(), set.end(), [&](const char* word) { return hasWord(words, {word}); }))
        return i;
    }
  }
  return std::nullopt;
}

double timeUnit(const std::vector<std::string>& words) {
  if (hasWord(words, {"ns", "nanoseconds"})) return 1e-9;
  if (hasWord(words, {"ms", "milliseconds"})) return 1e-3;
  if (hasWord(words, {"min", "mins", "minutes"})) return 60.0;
  if (hasWord(words, {"s", "sec", "secs", "seconds"})) return 1.0;
  return 0.0;
}

/// Whether the line is a header; then `layout` follows it. Throws InputError where it names no depth.
bool readHeader(const std::string& line, const std::string& file, Layout* layout) {
  const std::vector<std::string> names = fieldsOf(line, layout->separator);
  if (std::none_of(line.begin(), line.end(), [](unsigned char c) { return std::isalpha(c); })) return false;
  if (!names.empty() && parseProfileTime(names[0], 1.0)) return false;  // a date has letters too
  const std::optional<size_t> depth = firstColumn(names, {{"sample", "depth"}, {"depth"}});
  const std::optional<size_t> time = firstColumn(
      names,
      {{"sample", "time"}, {"elapsed"}, {"time"}, {"timestamp"}, {"stamp"}, {"t"}, {"datetime"}, {"date"}});
  if (!depth || !time || *depth == *time) {
    throw InputError(
        fmt::format("{}: the header '{}' names no columns of time and depth; call them 'time [s]' and "
                    "'depth [m]'",
                    file, line));
  }
  layout->time_column = *time;
  layout->depth_column = *depth;
  layout->seconds_per_unit = timeUnit(wordsOf(names[*time]));
  if (hasWord(wordsOf(names[*depth]), {"ft", "feet", "foot"})) layout->metres_per_unit = kMetresPerFoot;
  return true;
}

std::optional<DepthReading> readRow(const std::string& line, Layout* layout) {
  const std::vector<std::string> fields = fieldsOf(line, layout->separator);
  if (fields.size() <= std::max(layout->time_column, layout->depth_column)) return std::nullopt;
  const std::string& time = fields[layout->time_column];
  double number = 0.0;
  if (layout->seconds_per_unit == 0.0 && csv::parse(time, &number)) {
    layout->seconds_per_unit = std::abs(number) > 1e15 ? 1e-9 : 1.0;
  }
  const std::optional<double> time_s = parseProfileTime(time, layout->seconds_per_unit);
  double depth = 0.0;
  if (!time_s || !csv::parse(fields[layout->depth_column], &depth) || !std::isfinite(depth))
    return std::nullopt;
  return DepthReading{*time_s, depth * layout->metres_per_unit};
}

double resolutionOf(const std::vector<DepthReading>& readings) {
  std::vector<double> depths;
  for (const DepthReading& reading : readings) depths.push_back(reading.depth_m);
  std::sort(depths.begin(), depths.end());
  double smallest_m = depths.back() - depths.front();
  for (size_t i = 1; i < depths.size(); ++i) {
    const double step_m = depths[i] - depths[i - 1];
    if (step_m > 1e-6) smallest_m = std::min(smallest_m, step_m);
  }
  return smallest_m;
}

void settleSign(std::vector<DepthReading>* readings) {
  const bool are_heights = std::all_of(readings->begin(), readings->end(),
                                       [](const DepthReading& reading) { return reading.depth_m <= 0.0; });
  if (!are_heights) return;
  for (DepthReading& reading : *readings) reading.depth_m = -reading.depth_m;
}

}  // namespace

DepthProfile readDepthProfile(const std::filesystem::path& file, Diagnostics* diagnostics) {
  constexpr size_t kFewestReadings = 10;
  std::ifstream stream(file);
  if (!stream) throw InputError(file.string() + ": cannot be opened; give a CSV file with time and depth");
  DepthProfile profile;
  profile.name = file.filename().string();
  Layout layout;
  bool is_first = true;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // byte order mark of spreadsheets
    if (line.empty() || (line[0] == '#' && !is_first)) continue;
    if (is_first) layout.separator = separatorOf(line);
    if (std::exchange(is_first, false) && readHeader(line, file.string(), &layout)) continue;
    const std::optional<DepthReading> reading = readRow(line, &layout);
    if (!reading || (!profile.readings.empty() && reading->time_s <= profile.readings.back().time_s)) {
      diagnostics->report(Severity::Warning, "profile_line",
                          fmt::format("{}:{}: '{}' is no later time with a depth; passed over", file.string(),
                                      number, line.substr(0, 60)));
      continue;
    }
    profile.readings.push_back(*reading);
  }
  if (profile.readings.size() < kFewestReadings) {
    throw InputError(
        fmt::format("{}: only {} usable readings; a depth profile takes {} lines of time and depth",
                    file.string(), profile.readings.size(), kFewestReadings));
  }
  settleSign(&profile.readings);
  profile.resolution_m = resolutionOf(profile.readings);
  return profile;
}

}  // namespace lodeline
