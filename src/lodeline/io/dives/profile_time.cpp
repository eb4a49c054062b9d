#include "lodeline/io/dives/profile_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "lodeline/io/tables/calendar_time.h"

namespace lodeline {

namespace {

/// `text` without the name of a time zone at its end, such as " CEST".
std::string_view withoutZoneName(std::string_view text) {
  constexpr size_t kLongest = 5;
  const size_t blank = text.find_last_of(' ');
  if (blank == std::string_view::npos || text.size() - blank - 1 > kLongest) return text;
  const std::string_view name = text.substr(blank + 1);
  const bool is_name = std::all_of(name.begin(), name.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
  return is_name ? text.substr(0, blank) : text;
}

}  // namespace

std::optional<double> parseProfileTime(std::string_view text) {
  std::optional<int64_t> ns = parseCalendarTime_ns(text);
  if (!ns) ns = parseCalendarTime_ns(withoutZoneName(text));
  if (!ns) return std::nullopt;
  // In two parts, so that whole seconds stay exact.
  const int64_t whole_s = *ns / 1'000'000'000;
  return static_cast<double>(whole_s) + 1e-9 * static_cast<double>(*ns % 1'000'000'000);
}

std::string profileStart(std::string_view date) {
  // The offset from UTC is left out: the text shows the clock of the diver.
  const size_t time = date.find('T');
  const size_t offset = time == std::string_view::npos ? time : date.find_first_of("Z+-", time);
  const std::string_view text = date.substr(0, offset);
  const bool is_date = text.find_first_of("-./") < text.find(':');
  const std::optional<int64_t> start_ns = is_date ? parseCalendarTime_ns(text) : std::nullopt;
  if (!start_ns) return "";
  const std::chrono::sys_seconds start = std::chrono::round<std::chrono::seconds>(
      std::chrono::sys_time<std::chrono::nanoseconds>(std::chrono::nanoseconds(*start_ns)));
  const auto day = std::chrono::floor<std::chrono::days>(start);
  const std::chrono::year_month_day ymd(day);
  const std::chrono::hh_mm_ss clock(start - day);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02}", static_cast<int>(ymd.year()),
                     static_cast<unsigned>(ymd.month()), static_cast<unsigned>(ymd.day()),
                     clock.hours().count(), clock.minutes().count(), clock.seconds().count());
}

}  // namespace lodeline
