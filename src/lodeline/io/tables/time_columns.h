#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lodeline/io/tables/column_name.h"
#include "lodeline/util/time/time_unit.h"

namespace lodeline {

/// A time column, optionally in two parts: seconds and nanoseconds, or weeks and seconds of the week.
struct TimeColumn {
  std::size_t column = 0;
  std::string name;
  std::optional<TimeUnit> unit;       ///< where the name states it
  int64_t units_per_count = 1;        ///< 100 (us) for Xsens' SampleTimeFine, otherwise 1
  std::string unknown_unit;           ///< a unit in brackets that is not a time unit
  std::optional<std::size_t> second;  ///< column of the other part
  int64_t second_ns = 0;              ///< nanoseconds per unit of the other part
};

/// All columns whose names or units denote a time, best first: the stamp of a message's header, then times
/// and stamps, then dates and relative times.
std::vector<TimeColumn> findTimeColumns(const std::vector<ColumnName>& columns);

/// The time in a row, exact to the nanosecond, from the cell and the second part's cell where there is one.
/// The cell may also be a date and time of day (see calendar_time.h). Returns nothing where they are not
/// times or the time exceeds 64 bits.
std::optional<int64_t> timeFrom_ns(const TimeColumn& time, TimeUnit unit, std::string_view cell,
                                   std::string_view second_cell);

}  // namespace lodeline
