#include "lodeline/io/video/frame_stamps.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodeline/io/streams/stream_rate.h"
#include "lodeline/io/tables/table_reader.h"
#include "lodeline/io/tables/time_columns.h"
#include "lodeline/util/time/time_unit.h"

namespace lodeline {

FrameStamps::FrameStamps(const std::filesystem::path& file, Diagnostics* diagnostics) {
  TableOptions options;
  options.is_header = [](const std::vector<ColumnName>& columns) {
    return !findTimeColumns(columns).empty();
  };
  options.rows_may_be_short = true;
  TableReader table(file, options, diagnostics);
  size_t column = 0;
  std::optional<TimeUnit> unit;
  if (table.hasHeader()) {
    const TimeColumn time = findTimeColumns(table.columns()).front();
    column = time.column;
    unit = time.unit;
  }
  std::vector<std::string> texts;
  std::vector<double> numbers;
  bool has_decimals = false;
  while (table.next()) {
    // A header of several words may stand above a single column.
    const size_t used = table.cell(column).empty() ? 0 : column;
    const std::optional<double> number = table.number(used);
    if (!number || !std::isfinite(*number)) {
      table.passOver("holds no stamp");
      continue;
    }
    texts.emplace_back(table.cell(used));
    numbers.push_back(*number);
    has_decimals = has_decimals || texts.back().find('.') != std::string::npos;
  }
  if (!unit) {
    const TimeUnit usual = has_decimals ? TimeUnit::Seconds : TimeUnit::Nanoseconds;
    const size_t first = std::min(numbers.size(), kStampsForRate);
    unit =
        timeUnitOfStamps({numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(first)}, kCameraRate)
            .value_or(usual);
  }
  for (const std::string& text : texts) {
    const std::optional<int64_t> ns = parseTime_ns(text, *unit);
    if (ns) stamps_.push_back(Time::fromNanoseconds(*ns));
  }
  if (stamps_.empty()) throw InputError(file.string() + ": holds no stamps of images");
}

std::optional<Time> FrameStamps::next() {
  if (next_ >= stamps_.size()) return std::nullopt;
  return stamps_[next_++];
}

std::vector<Time> FrameStamps::first() const {
  const size_t count = std::min(stamps_.size(), kStampsForRate);
  return {stamps_.begin(), stamps_.begin() + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace lodeline
