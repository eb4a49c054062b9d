#include "lodeline/io/euroc/current_table.h"

#include <fmt/core.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/robots/channel_order.h"
#include "lodeline/io/tables/time_columns.h"

namespace lodeline {
namespace {

/// From a battery that is sampled each minute to a logger of motors.
constexpr PlausibleRate kCurrentRate = {1.0 / 120.0, 1e3};

/// The name without its unit in brackets.
std::string channelOf(const ColumnName& column) {
  if (column.unit.empty()) return column.text;
  return std::string(trimmed(std::string_view(column.text).substr(0, column.text.find_last_of("[("))));
}

}  // namespace

CurrentTable::CurrentTable(const std::filesystem::path& file, const std::vector<std::string>& channels,
                           Diagnostics* diagnostics)
    : file_(file),
      channels_(channels),
      reader_(file,
              CsvLayout{1, [this](const std::vector<ColumnName>& columns) { return findColumns(columns); },
                        "#timestamp [ns],thruster_1 [A],lamp [A]"},
              diagnostics, kCurrentRate) {}

CsvColumns CurrentTable::findColumns(const std::vector<ColumnName>& columns) {
  const std::vector<TimeColumn> times = findTimeColumns(columns);
  if (times.empty()) throw InputError(file_.string() + ": its header names no column of time stamps");
  std::vector<std::string> names;
  std::vector<CsvColumn> found;
  for (size_t i = 0; i < columns.size(); ++i) {
    if (i == times.front().column) continue;
    names.push_back(channelOf(columns[i]));
    found.push_back({i, unitFactorOf(file_, statedUnit(columns[i], Quantity::Current), Quantity::Current)});
  }
  CsvColumns result;
  std::vector<std::string> ordered;
  for (const size_t place : channelOrder(file_.string(), names, channels_)) {
    result.numbers.push_back(found[place]);
    ordered.push_back(names[place]);
  }
  channels_ = std::move(ordered);
  return result;
}

std::optional<CurrentSample> CurrentTable::next() {
  if (!reader_.next(&row_)) return std::nullopt;
  return CurrentSample{row_.time, row_.numbers};
}

std::string currentHeader(const std::vector<std::string>& channels) {
  std::string header = "#timestamp [ns]";
  for (const std::string& channel : channels) header += fmt::format(",{} [A]", channel);
  return header + "\n";
}

}  // namespace lodeline
