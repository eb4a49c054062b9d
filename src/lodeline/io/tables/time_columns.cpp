#include "lodeline/io/tables/time_columns.h"

#include <algorithm>

#include "lodeline/io/tables/calendar_time.h"
#include "lodeline/io/tables/cells.h"

namespace lodeline {
namespace {

constexpr int64_t kNanosecondsPerWeek = 604'800'000'000'000;

/// Whether the letter t at the end is the tesla of a unit, as in "mag_x_uT", "field_y_T".
bool endsInTesla(const ColumnName& column) {
  constexpr std::string_view kBefore = "unmxyz";
  const std::size_t count = column.words.size();
  return count > 1 && column.words[count - 1] == "t" && column.words[count - 2].size() == 1 &&
         kBefore.find(column.words[count - 2][0]) != std::string_view::npos;
}

bool isTime(const ColumnName& column) {
  if (column.hasWord({"t"}) && !endsInTesla(column)) return true;
  if (column.words.size() == 1 && column.hasWord({"sec", "seconds"})) return true;
  if (column.hasWord({"uptime", "tow",   "date",    "datetime", "epoch",   "clock", "millis",
                      "micros", "ticks", "elapsed", "nsecs",    "nanosec", "secs",  "tid",
                      "tijd",   "zeit",  "temps",   "tiempo",   "tempo",   "czas",  "cas"}) ||
      column.hasStem({"time", "stamp"})) {
    return true;
  }
  return !column.unit.empty() && timeUnitOfName("t [" + column.unit + "]").has_value();
}

/// Rank of a time column: the sensor's own stamp has priority over those of a recorder.
int rankOfTime(const ColumnName& column) {
  if (column.hasWord({"header"}) && column.hasStem({"stamp"})) return 0;
  if (column.hasWord({"date", "datetime"}) || column.hasStem({"sample", "relative"})) return 3;
  if (column.hasWord({"t"}) || column.hasStem({"time", "stamp", "zeit", "tow"})) return 1;
  return 2;
}

bool isNanoseconds(const ColumnName& column) {
  return column.hasWord({"nsecs", "nsec", "nanosec", "nanosecs", "nanoseconds"});
}
bool isSeconds(const ColumnName& column) { return column.hasWord({"secs", "sec", "seconds"}); }

}  // namespace

std::vector<TimeColumn> findTimeColumns(const std::vector<ColumnName>& columns) {
  std::vector<TimeColumn> times;
  std::vector<int> ranks;
  std::optional<std::size_t> week;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const ColumnName& column = columns[i];
    if (column.hasWord({"week", "wk", "gwk"})) week = i;
    const bool is_second_part = i > 0 && isNanoseconds(column) && isSeconds(columns[i - 1]);
    if (is_second_part && !times.empty() && times.back().column == i - 1) {
      times.back().second = i;
      times.back().second_ns = 1;
      continue;
    }
    if (!isTime(column) || column.hasStem({"integral"}) || column.hasWord({"week"})) continue;
    TimeColumn time;
    time.column = i;
    time.name = column.text;
    time.unit = timeUnitOfName(column.unit.empty() ? column.text : "t [" + column.unit + "]");
    if (!time.unit && !column.unit.empty()) time.unknown_unit = column.unit;
    if (column.hasWord({"sample"}) && column.hasWord({"fine"}) && !time.unit) {
      time.unit = TimeUnit::Microseconds;
      time.units_per_count = 100;
    }
    if (column.hasWord({"tow"}) && week && !time.unit) time.unit = TimeUnit::Seconds;
    if (column.hasWord({"tow"}) && week) {
      time.second = week;
      time.second_ns = kNanosecondsPerWeek;
    }
    times.push_back(time);
    ranks.push_back(time.unknown_unit.empty() ? rankOfTime(column) : 4);
  }
  std::vector<std::size_t> order(times.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return ranks[a] < ranks[b]; });
  std::vector<TimeColumn> sorted;
  for (const std::size_t i : order) sorted.push_back(times[i]);
  return sorted;
}

std::optional<int64_t> timeFrom_ns(const TimeColumn& time, TimeUnit unit, std::string_view cell,
                                   std::string_view second_cell) {
  const std::optional<int64_t> counts_ns = parseTime_ns(withDecimalPoint(cell), unit);
  int64_t ns = 0;
  if (!counts_ns && !time.second) return parseCalendarTime_ns(withDecimalPoint(cell));
  if (!counts_ns || __builtin_mul_overflow(*counts_ns, time.units_per_count, &ns)) return std::nullopt;
  if (!time.second) return ns;
  const std::optional<int64_t> second = parseTime_ns(second_cell, TimeUnit::Nanoseconds);
  int64_t second_ns = 0;
  if (!second || __builtin_mul_overflow(*second, time.second_ns, &second_ns) ||
      __builtin_add_overflow(ns, second_ns, &ns)) {
    return std::nullopt;
  }
  return ns;
}

}  // namespace lodeline
