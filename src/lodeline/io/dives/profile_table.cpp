#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <regex>
#include <string>

#include "lodeline/diagnostics.h"
#include "lodeline/io/dives/profile_columns.h"
#include "lodeline/io/dives/profile_rows.h"
#include "lodeline/io/dives/profile_time.h"
#include "lodeline/io/tables/table_reader.h"
#include "lodeline/io/tables/units.h"
#include "lodeline/util/time/time_unit.h"

namespace lodeline {
namespace {

constexpr const char* kFinding = "profile_line";

std::string lowerCase(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return result;
}

/// Whether the names are a header: with depth and time of each sample, or a
/// plain "Depth" where the readings are evenly spaced.
bool isProfileHeader(const std::vector<ColumnName>& names) {
  const std::optional<ProfileColumns> columns = profileColumns(names);
  if (!columns) return false;
  // Excludes prose, and names with another separator.
  const auto isSeveral = [](const ColumnName& name) {
    return name.text.find_first_of(",;") != std::string::npos;
  };
  if (std::any_of(names.begin(), names.end(), isSeveral)) return false;
  return columns->time.has_value() || (names.size() > 1 && names[columns->depth].words.size() == 1);
}

/// The columns of a table without a header.
ProfileColumns firstTwo() {
  ProfileColumns columns;
  columns.time = 0;
  columns.depth = 1;
  return columns;
}

ProfileColumns columnsOf(const TableReader& table, const std::string& file) {
  if (table.hasHeader()) return profileColumns(table.columns()).value();
  const bool is_named = !table.unknownHeader().empty();
  if (!is_named && table.columnCount() != 1) return firstTwo();
  const std::string header = lowerCase(table.unknownHeader());
  const bool is_pressure =
      header.find("press") != std::string::npos || header.find("druck") != std::string::npos;
  throw InputError(fmt::format(
      "{}: {} columns of time and depth; call them 'time [s]' and 'depth [m]'{}", file,
      is_named ? fmt::format("the header '{}' names no", excerpt(table.unknownHeader())) : "there are no",
      is_pressure
          ? ". A pressure becomes a depth less that at the surface: 1 bar is 10.2 m of fresh and 9.95 m "
            "of sea water"
          : ""));
}

/// Metres per unit from lines before the header: a column "Imperial Units" with
/// True or False below, or a line such as "Units: imperial", "# depth unit:
/// ft".
std::optional<double> unitInPreamble(const std::vector<std::string>& preamble) {
  constexpr double kMetresPerFoot = 0.3048;
  for (size_t i = 0; i < preamble.size(); ++i) {
    const std::string line = lowerCase(preamble[i]);
    // The logs of Seabear's computers name no unit, and are in metres.
    if (line.starts_with("//seabear")) return 1.0;
    const Separator separator = separatorOf(line);
    std::vector<std::string_view> names, values;
    std::vector<std::string> unquoted, unquoted_values;
    splitCells(line, separator, &names, &unquoted);
    const auto imperial = std::find(names.begin(), names.end(), "imperial units");
    if (imperial != names.end() && i + 1 < preamble.size()) {
      const std::string next = lowerCase(preamble[i + 1]);
      splitCells(next, separator, &values, &unquoted_values);
      const auto column = static_cast<size_t>(imperial - names.begin());
      if (column < values.size())
        return values[column] == "true" || values[column] == "1" ? kMetresPerFoot : 1.0;
    }
    static const std::regex kUnits(R"(\b(units?|depth)\b.*\b(imperial|feet|ft|metric|metres?|meters?|m)\b)");
    std::smatch match;
    if (names.size() > 2 || !std::regex_search(line, match, kUnits)) continue;
    const std::string unit = match[2];
    return unit == "imperial" || unit == "feet" || unit == "ft" ? kMetresPerFoot : 1.0;
  }
  return std::nullopt;
}

/// Seconds between readings without times: "Log interval: 5 s".
std::optional<double> intervalInPreamble(const std::vector<std::string>& preamble) {
  static const std::regex kInterval(
      R"(\b(?:interval|rate)\b[^0-9]*([0-9]+(?:\.[0-9]+)?)\s*(s|sec|seconds|min)?\b)");
  for (const std::string& line : preamble) {
    const std::string text = lowerCase(line);
    std::smatch match;
    if (!std::regex_search(text, match, kInterval) || text.find("surface") != std::string::npos) continue;
    return numberFrom(match[1].str()).value_or(0.0) * (match[2] == "min" ? 60.0 : 1.0);
  }
  return std::nullopt;
}

/// Metres per unit from the column's name or the lines before the header.
std::optional<double> depthUnit(const TableReader& table, size_t column, const std::string& file) {
  if (!table.hasHeader()) return std::nullopt;
  const StatedUnit unit = statedUnit(table.columns()[column], Quantity::Length);
  if (unit.factor) return unit.factor;
  if (unit.isUnknown()) {
    const std::string name = lowerCase(unit.text);
    if (name == "msw") return 1.0;
    if (name == "fsw") return 0.3048;
    throw InputError(
        fmt::format("{}: the depths are in '{}', which is no "
                    "known unit of depth; give them in one of {}",
                    file, unit.text, knownUnits(Quantity::Length)));
  }
  return unitInPreamble(table.preamble());
}

/// A depth with or without its unit behind it ("12.5", "12,5 m").
std::optional<double> depthFrom(std::string_view cell, std::optional<double>* metres_per_unit) {
  if (const std::optional<double> number = numberFrom(cell)) return number;
  const size_t end = cell.find_last_of("0123456789");
  if (end == std::string_view::npos) return std::nullopt;
  const std::optional<double> factor = unitFactor(Quantity::Length, trimmed(cell.substr(end + 1)));
  const std::optional<double> number = numberFrom(trimmed(cell.substr(0, end + 1)));
  if (!factor || !number || (*metres_per_unit && **metres_per_unit != *factor)) return std::nullopt;
  *metres_per_unit = factor;
  return number;
}

/// Times of readings: seconds for clocks and dates; plain numbers until their
/// unit is known.
class Times {
 public:
  Times(const TableReader& table, const ProfileColumns& columns) : columns_(columns) {
    if (!columns_.time) {
      interval_s_ = intervalInPreamble(table.preamble());
      return;
    }
    if (!table.hasHeader()) return;
    const std::string& name = table.columns()[*columns_.time].text;
    unit_ = timeUnitOfName(name);
    const std::string lower = lowerCase(name);
    counts_hours_ = lower.find("h:mm") != std::string::npos && lower.find("ss") == std::string::npos;
  }

  bool canTell() const { return columns_.time || interval_s_; }

  /// Time in seconds, or a number of unknown unit (then `is_number`); empty
  /// where the row has no time.
  std::optional<double> of(const TableReader& table, size_t row, bool* is_number) const {
    *is_number = false;
    if (!columns_.time) return static_cast<double>(row) * *interval_s_;
    const std::string_view cell = table.cell(*columns_.time);
    if (const std::optional<double> number = numberFrom(cell)) {
      *is_number = true;
      return number;
    }
    std::optional<double> time_s = parseProfileTime(cell);
    if (time_s && counts_hours_) time_s = *time_s * 60.0;
    if (!time_s || !columns_.date) return time_s;
    const std::optional<double> day_s = parseProfileTime(table.cell(*columns_.date));
    return day_s && *day_s > 86400.0 ? *day_s + *time_s : *time_s;
  }

  /// Seconds per plain number: from the column's unit, else seconds if that is
  /// a plausible interval of a dive log.
  double secondsPerNumber(const std::vector<double>& numbers) const {
    if (unit_) return static_cast<double>(nanosecondsPer(*unit_)) / 1e9;
    const double largest = numbers.empty() ? 0.0 : std::abs(numbers[numbers.size() / 2]);
    constexpr double kLargestInSeconds = 1e10;
    const double per_unit = stampsPerUnit(numbers);
    if (largest < kLargestInSeconds && per_unit <= 100.0 && per_unit >= 1.0 / 600.0) return 1.0;
    const TimeUnit unit = timeUnitOfStamps(numbers, kDepthRate).value_or(TimeUnit::Seconds);
    return static_cast<double>(nanosecondsPer(unit)) / 1e9;
  }

 private:
  ProfileColumns columns_;
  std::optional<TimeUnit> unit_;
  std::optional<double> interval_s_;
  bool counts_hours_ = false;
};

/// Removes a block of up to three rows before an empty line, whose columns have
/// another meaning.
void dropBlockBefore(std::vector<ProfileRow>* rows, std::vector<bool>* are_numbers) {
  constexpr size_t kMostRows = 3;
  for (size_t i = 1; i <= kMostRows && i < rows->size(); ++i) {
    if ((*rows)[i].line == (*rows)[i - 1].line + 1) continue;
    rows->erase(rows->begin(), rows->begin() + static_cast<std::ptrdiff_t>(i));
    are_numbers->erase(are_numbers->begin(), are_numbers->begin() + static_cast<std::ptrdiff_t>(i));
    return;
  }
}

}  // namespace

ProfileRows readProfileTable(const std::filesystem::path& file, Diagnostics* diagnostics) {
  TableOptions options;
  options.is_header = isProfileHeader;
  options.finding = kFinding;
  options.rows_may_be_short = true;
  TableReader table(file, options, diagnostics);
  ProfileRows profile;
  if (table.columnCount() == 0 && table.unknownHeader().empty()) return profile;
  const ProfileColumns columns = columnsOf(table, file.string());
  const Times times(table, columns);
  if (!times.canTell()) {
    throw InputError(
        fmt::format("{}: the header names a depth but no time; "
                    "call the columns 'time [s]' and 'depth [m]'",
                    file.string()));
  }
  profile.metres_per_unit = depthUnit(table, columns.depth, file.string());
  std::vector<bool> are_numbers;
  std::string dive_name;
  for (int dive = 0; table.next();) {
    bool is_number = false;
    const std::optional<double> time = times.of(table, profile.rows.size(), &is_number);
    const std::optional<double> depth = depthFrom(table.cell(columns.depth), &profile.metres_per_unit);
    if (!time || !depth || !std::isfinite(*time) || !std::isfinite(*depth)) {
      const std::string_view time_cell = columns.time ? table.cell(*columns.time) : std::string_view();
      table.passOver(fmt::format("no time with a depth: '{}' and '{}'", excerpt(time_cell),
                                 excerpt(table.cell(columns.depth))));
      continue;
    }
    if (columns.dive && table.cell(*columns.dive) != dive_name) {
      dive_name = table.cell(*columns.dive);
      profile.dives.push_back({dive_name, ""});
      ++dive;
    }
    profile.rows.push_back({*time, *depth, dive, table.line()});
    are_numbers.push_back(is_number);
  }
  dropBlockBefore(&profile.rows, &are_numbers);
  if (!columns.time && !profile.rows.empty()) {
    // Counted times begin with the first reading.
    const double first_s = profile.rows.front().time_s;
    for (ProfileRow& row : profile.rows) row.time_s -= first_s;
  }
  std::vector<double> numbers;
  for (size_t i = 0; i < profile.rows.size(); ++i) {
    if (are_numbers[i]) numbers.push_back(profile.rows[i].time_s);
  }
  const double seconds = times.secondsPerNumber(numbers);
  for (size_t i = 0; i < profile.rows.size(); ++i) {
    if (are_numbers[i]) profile.rows[i].time_s *= seconds;
  }
  return profile;
}

}  // namespace lodeline
