#include "lodeline/export/profile_time.h"

#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "lodeline/base/csv_fields.h"

namespace lodeline {
namespace {

/// "1:15" or "0:01:15.5": seconds.
std::optional<double> parseClock(std::string_view text) {
  std::vector<double> parts;
  while (true) {
    const size_t colon = text.find(':');
    double part = 0.0;
    if (!csv::parse(text.substr(0, colon), &part) || part < 0.0) return std::nullopt;
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

/// Cuts "Z", "+02:00", "-0430" off the end of a time of day and gives its seconds; nothing where it is
/// malformed.
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

std::optional<double> parseDate(std::string_view text) {
  if (text.size() < 16 || text[4] != '-' || text[7] != '-' || (text[10] != 'T' && text[10] != ' '))
    return std::nullopt;
  int year = 0;
  unsigned month = 0, day = 0;
  if (!csv::parse(text.substr(0, 4), &year) || !csv::parse(text.substr(5, 2), &month) ||
      !csv::parse(text.substr(8, 2), &day)) {
    return std::nullopt;
  }
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month),
                                         std::chrono::day(day)};
  if (!date.ok()) return std::nullopt;
  std::string_view clock = csv::trimmed(text.substr(11));
  const std::optional<double> offset_s = takeOffset(&clock);
  // "12:00" is hours and minutes here; a clock without seconds gets them.
  const std::string full = clock.size() == 5 ? std::string(clock) + ":00" : std::string(clock);
  const std::optional<double> of_day_s = parseClock(full);
  if (!offset_s || !of_day_s) return std::nullopt;
  const auto days = std::chrono::sys_days(date).time_since_epoch().count();
  return 86400.0 * static_cast<double>(days) + *of_day_s - *offset_s;
}

}  // namespace

std::optional<double> parseProfileTime(std::string_view text, double seconds_per_unit) {
  double number = 0.0;
  if (csv::parse(text, &number)) {
    if (!std::isfinite(number)) return std::nullopt;
    return number * seconds_per_unit;
  }
  if (std::optional<double> date = parseDate(text)) return date;
  return parseClock(text);
}

}  // namespace lodeline
