#include "lodeline/io/rosbag/convert/folder_parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <vector>

#include "lodeline/io/euroc/euroc_rig.h"
#include "lodeline/io/synchronizer/recording_file.h"
#include "lodeline/sensors/sensor_kind.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

bool isSensor(const std::string& name) {
  return name.starts_with("cam") ||
         std::find(kSingleSensors.begin(), kSingleSensors.end(), name) != kSingleSensors.end();
}

/// Folders in mav0 whose table holds no readings of a sensor, in the order of their names.
std::vector<fs::path> otherFolders(const fs::path& mav0) {
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::directory_iterator(mav0)) {
    const bool has_table = fs::is_regular_file(entry.path() / "data.csv");
    if (has_table && !isSensor(entry.path().filename().string())) folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

/// The stamp of a row: whole nanoseconds in its first cell.
std::optional<Time> stampOfRow(const std::string& line) {
  const size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string::npos) return std::nullopt;
  int64_t ns = 0;
  const char* const end = line.data() + line.size();
  const auto [rest, error] = std::from_chars(line.data() + begin, end, ns);
  const bool is_whole = rest == end || *rest == ',' || *rest == ' ' || *rest == '\t' || *rest == '\r';
  if (error != std::errc() || !is_whole) return std::nullopt;
  return Time::fromNanoseconds(ns);
}

/// Copies one table; returns the number of rows, or nothing where a row has no stamp.
std::optional<int> copyTable(const fs::path& table, const fs::path& copy,
                             const std::function<bool(Time)>& contains) {
  std::ifstream stream(table, std::ios::binary);
  RecordingFile file(copy);
  int rows = 0;
  bool is_header = true;
  for (std::string line; std::getline(stream, line);) {
    const std::optional<Time> stamp = stampOfRow(line);
    const bool is_comment = line.find_first_not_of(" \t\r") == std::string::npos || line.front() == '#';
    is_header = is_header && !stamp;
    if (!stamp && !is_comment && !is_header) return std::nullopt;
    if (stamp && !contains(*stamp)) continue;
    rows += stamp ? 1 : 0;
    file.write(line + "\n");
  }
  file.close();
  return rows;
}

}  // namespace

EurocOptions everythingIn(const fs::path& folder, const ConvertOptions& options) {
  EurocOptions everything;
  everything.rig_files = options.rig_files;
  everything.with_cameras = false;
  const EurocLayout layout = findEurocLayout(folder, everything);
  for (const fs::directory_entry& entry : fs::directory_iterator(layout.mav0)) {
    if (entry.path().filename().string().starts_with("cam")) everything.with_cameras = true;
  }
  everything.camera_indices = options.cameras;
  return everything;
}

void copyOtherTables(const fs::path& mav0, const fs::path& target, const std::function<bool(Time)>& contains,
                     std::map<std::string, int>* rows, Diagnostics* diagnostics) {
  for (const fs::path& folder : otherFolders(mav0)) {
    const std::string name = folder.filename().string();
    const fs::path copy = target / name;
    const std::optional<int> count = copyTable(folder / "data.csv", copy / "data.csv", contains);
    if (!count || *count == 0) {
      fs::remove_all(copy);
      diagnostics->report(Severity::Notice, "convert_left_out",
                          fmt::format("{}: {}; the table is left out", (folder / "data.csv").string(),
                                      count ? "no row lies in the part that is converted"
                                            : "its rows do not begin with stamps in nanoseconds"));
      continue;
    }
    (*rows)[name] = *count;
    std::error_code ignored;
    fs::copy_file(folder / "sensor.yaml", copy / "sensor.yaml", ignored);
  }
}

}  // namespace lodeline
