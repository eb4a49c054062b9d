#include "lodeline/io/tables/calendar_time.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "lodeline/util/csv_fields.h"

namespace lodeline {
namespace {

/// "1:15" or "0:01:15.5": seconds.
std::optional<double> parseClock(std::string_view text) {
  std::vector<double> parts;
  while (true) {
    const size_t colon = text.find(':');
    double part = 0.0;
    if (!csv::parse(text.substr(0, colon), &part) || !std::isfinite(part) || part < 0.0) return std::nullopt;
    parts.push_back(part);
    if (colon == std::string_view::npos) break;
    text.remove_prefix(colon + 1);
  }
  if (parts.size() < 2 || parts.size() > 3) return std::nullopt;
  double seconds = 0.0;
  for (size_t i = 0; i < parts.size(); ++i) {
    if (i > 0 && parts[i] >= 60.0) return std::nullopt;
    seconds = 60.0 * seconds + parts[i];
  }
  return seconds;
}

/// Removes "Z", "+02:00", "-0430" from the end of a time of day and returns the
/// offset in seconds; empty where it is malformed.
std::optional<double> takeOffset(std::string_view* clock) {
  if (clock->ends_with('Z')) {
    clock->remove_suffix(1);
    return 0.0;
  }
  const size_t sign = clock->find_last_of("+-");
  if (sign == std::string_view::npos) return 0.0;
  std::string_view digits = clock->substr(sign + 1);
  const double direction = (*clock)[sign] == '-' ? -1.0 : 1.0;
  *clock = clock->substr(0, sign);
  int hours = 0, minutes = 0;
  if (digits.size() < 2 || !csv::parse(digits.substr(0, 2), &hours)) return std::nullopt;
  digits.remove_prefix(2);
  if (digits.starts_with(':')) digits.remove_prefix(1);
  if (!digits.empty() && !csv::parse(digits, &minutes)) return std::nullopt;
  return direction * (3600.0 * hours + 60.0 * minutes);
}

/// A number, or 1 to 12 for the English name of a month: "Nov", "november".
bool parseDayPart(std::string_view text, int* part) {
  if (csv::parse(text, part)) return true;
  constexpr std::array<std::string_view, 12> kMonths = {"jan", "feb", "mar", "apr", "may", "jun",
                                                        "jul", "aug", "sep", "oct", "nov", "dec"};
  std::string start(text.substr(0, 3));
  std::transform(start.begin(), start.end(), start.begin(), [](unsigned char c) { return std::tolower(c); });
  const auto month = std::find(kMonths.begin(), kMonths.end(), start);
  *part = static_cast<int>(month - kMonths.begin()) + 1;
  return month != kMonths.end();
}

/// Days since 1970 of "2026-11-21", "21.11.2026", "21-Nov-2026", "11/21/2026"; with slashes
/// the month comes first unless it is not a valid month.
std::optional<double> parseDay(std::string_view text) {
  int parts[3];
  size_t lengths[3];
  char mark = 0;
  for (size_t i = 0; i < 3; ++i) {
    const size_t end = i < 2 ? text.find_first_of("-./") : text.size();
    if (end == std::string_view::npos || !parseDayPart(text.substr(0, end), &parts[i])) return std::nullopt;
    lengths[i] = end;
    if (i == 2) break;
    if (i == 1 && text[end] != mark) return std::nullopt;
    mark = text[end];
    text.remove_prefix(end + 1);
  }
  const bool is_year_first = lengths[0] == 4;
  if (!is_year_first && lengths[2] != 4) return std::nullopt;
  int year = parts[is_year_first ? 0 : 2], month = parts[1], day = parts[is_year_first ? 2 : 0];
  if (!is_year_first && mark == '/' && day <= 12) std::swap(day, month);
  if (!is_year_first && month > 12) std::swap(day, month);
  if (month < 1 || day < 1) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return std::nullopt;
  return static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

/// Seconds of a time of day: "10:34", "10:34:00.5", "3:04 PM", "12:00:00+02:00"
/// (less its offset).
std::optional<double> parseTimeOfDay(std::string_view clock) {
  double afternoon_s = 0.0;
  bool has_twelve_hours = false;
  for (const auto& [mark, seconds] : {std::pair{"am", 0.0}, {"AM", 0.0}, {"pm", 43200.0}, {"PM", 43200.0}}) {
    if (!clock.ends_with(mark)) continue;
    clock = csv::trimmed(clock.substr(0, clock.size() - 2));
    afternoon_s = seconds;
    has_twelve_hours = true;
  }
  const std::optional<double> offset_s = takeOffset(&clock);
  // Two numbers are hours and minutes in a time of day.
  const bool has_seconds = std::count(clock.begin(), clock.end(), ':') == 2;
  std::optional<double> of_day_s = parseClock(has_seconds ? std::string(clock) : std::string(clock) + ":00");
  if (!offset_s || !of_day_s) return std::nullopt;
  if (has_twelve_hours && *of_day_s >= 43200.0) *of_day_s -= 43200.0;
  return *of_day_s + afternoon_s - *offset_s;
}

/// Nanoseconds of a day since 1970 and a time of day; empty where they exceed 64 bits.
std::optional<int64_t> wholeNanoseconds(double day, double of_day_s) {
  constexpr double kMostDays = 106'000.0;
  if (!(std::abs(day) + std::abs(of_day_s) / 86400.0 < kMostDays)) return std::nullopt;
  return static_cast<int64_t>(day) * 86'400'000'000'000 + std::llround(1e9 * of_day_s);
}

std::optional<int64_t> parseDate(std::string_view text) {
  const size_t blank = text.find_first_of(" T");
  const std::optional<double> day = parseDay(text.substr(0, blank));
  if (!day) return std::nullopt;
  if (blank == std::string_view::npos) return wholeNanoseconds(*day, 0.0);
  const std::optional<double> of_day_s = parseTimeOfDay(csv::trimmed(text.substr(blank + 1)));
  return of_day_s ? wholeNanoseconds(*day, *of_day_s) : std::nullopt;
}

}  // namespace

std::optional<int64_t> parseCalendarTime_ns(std::string_view text) {
  if (const std::optional<int64_t> date = parseDate(text)) return date;
  const bool is_of_day = text.find_first_of("aApP") != std::string_view::npos;
  const std::optional<double> clock_s = is_of_day ? parseTimeOfDay(text) : parseClock(text);
  return clock_s ? wholeNanoseconds(0.0, *clock_s) : std::nullopt;
}

}  // namespace lodeline
