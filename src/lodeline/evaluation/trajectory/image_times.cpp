#include "lodeline/evaluation/trajectory/image_times.h"

#include <fmt/format.h>

#include <cstdlib>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

// Shorter integers are frame numbers, not nanoseconds of any clock set to the date.
constexpr std::size_t kMinNanosecondDigits = 17;

std::optional<Time> timeFromName(const std::string& image_name) {
  const std::string stem = std::filesystem::path(image_name).stem().string();
  if (isInteger(stem)) {
    if (stem.size() < kMinNanosecondDigits || stem.size() > 19) return std::nullopt;
    return Time::fromNanoseconds(std::strtoll(stem.c_str(), nullptr, 10));
  }
  Time time;
  if (stem.find('.') != std::string::npos && parseSeconds(stem, time)) return time;
  return std::nullopt;
}

}  // namespace

ImageTimes::ImageTimes(const std::filesystem::path& path) : has_file_(true) {
  const TextTable table = readTextTable(path);
  for (const TextLine& line : table.lines) {
    if (line.fields.size() != 2) {
      throw InputError(fmt::format("{}: {} columns, expected `name time[s]` or `time[ns],name`",
                                   table.where(line), line.fields.size()));
    }
    const bool euroc_order = isInteger(line.fields[0]) && line.fields[0].size() >= kMinNanosecondDigits &&
                             !isInteger(line.fields[1]);
    if (euroc_order) {
      time_by_name_[line.fields[1]] = table.timeInNanoseconds(line, 0);
    } else {
      time_by_name_[line.fields[0]] = table.timeInSeconds(line, 1);
    }
  }
}

std::optional<Time> ImageTimes::find(const std::string& image_name) const {
  if (!has_file_) return timeFromName(image_name);
  auto found = time_by_name_.find(image_name);
  if (found == time_by_name_.end()) {
    found = time_by_name_.find(std::filesystem::path(image_name).filename().string());
  }
  if (found == time_by_name_.end()) return std::nullopt;
  return found->second;
}

std::vector<Time> readImageStamps(const std::filesystem::path& path) {
  std::error_code ignored;
  const auto file = std::filesystem::is_directory(path, ignored) ? path / "data.csv" : path;
  const TextTable table = readTextTable(file);
  std::vector<Time> stamps;
  for (const TextLine& line : table.lines) stamps.push_back(table.timeInNanoseconds(line, 0));
  return stamps;
}

}  // namespace lodeline
