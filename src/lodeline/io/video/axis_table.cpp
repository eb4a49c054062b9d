#include "lodeline/io/video/axis_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

/// The column of an axis; nothing where none or several could be it.
std::optional<std::size_t> axisColumn(const std::vector<ColumnName>& columns, const char* axis) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (!columns[i].hasWord({axis})) continue;
    if (found) return std::nullopt;
    found = i;
  }
  return found;
}

bool namesAxes(const std::vector<ColumnName>& columns) {
  const bool has_axes = axisColumn(columns, "x") && axisColumn(columns, "y") && axisColumn(columns, "z");
  return has_axes && !findTimeColumns(columns).empty();
}

TableOptions options() {
  TableOptions options;
  options.is_header = namesAxes;
  options.least_columns = 4;
  return options;
}

}  // namespace

AxisTable::AxisTable(const std::filesystem::path& file, Quantity quantity, double usual_unit,
                     Diagnostics* diagnostics)
    : table_(file, options(), diagnostics), to_si_(usual_unit) {
  settleColumns(file, quantity);
}

void AxisTable::settleColumns(const std::filesystem::path& file, Quantity quantity) {
  if (!table_.hasHeader()) {
    if (table_.columnCount() != 4) {
      throw InputError(
          fmt::format("{}: {} columns without a header; expected x, y, z and a time in ns, or a "
                      "header that names them",
                      file.string(), table_.columnCount()));
    }
    time_.column = 3;
    time_.name = "column 4";
    return;
  }
  const std::vector<ColumnName>& columns = table_.columns();
  axes_ = {*axisColumn(columns, "x"), *axisColumn(columns, "y"), *axisColumn(columns, "z")};
  const StatedUnit stated = statedUnit(columns[axes_[0]], quantity);
  if (stated.isUnknown()) {
    throw InputError(fmt::format("{}: unit '{}' is not known for a {}; known are {}", file.string(),
                                 stated.text, toString(quantity), knownUnits(quantity)));
  }
  to_si_ = stated.factor.value_or(to_si_);
  const std::vector<TimeColumn> times = findTimeColumns(columns);
  const auto isAbsolute = [](const TimeColumn& time) {
    return time.name.find("elapsed") == std::string::npos;
  };
  const auto absolute = std::find_if(times.begin(), times.end(), isAbsolute);
  time_ = absolute != times.end() ? *absolute : times.front();
  const bool counts_seconds = time_.name.find("second") != std::string::npos;
  unit_ = time_.unit.value_or(counts_seconds ? TimeUnit::Seconds : TimeUnit::Nanoseconds);
}

std::optional<AxisTable::Reading> AxisTable::next() {
  while (table_.next()) {
    const std::optional<int64_t> ns = table_.time_ns(time_.column, unit_);
    Reading reading;
    bool is_usable = ns.has_value();
    for (int i = 0; i < 3 && is_usable; ++i) {
      const std::optional<double> number = table_.number(axes_[static_cast<std::size_t>(i)]);
      is_usable = number && std::isfinite(*number);
      if (is_usable) reading.value[i] = to_si_ * *number;
    }
    if (is_usable) {
      reading.time = Time::fromNanoseconds(*ns);
      return reading;
    }
    table_.passOver("a cell is no number");
  }
  return std::nullopt;
}

}  // namespace lodeline
