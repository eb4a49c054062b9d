#include "lodeline/io/dives/depth_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "lodeline/diagnostics.h"
#include "lodeline/io/dives/profile_rows.h"
#include "lodeline/io/dives/profile_screen.h"
#include "lodeline/io/logs/files/zip_archive.h"
#include "lodeline/io/tables/byte_source.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr size_t kFewestReadings = 10, kFewestOfStatedDive = 3;

double resolutionOf(const std::vector<DepthReading>& readings) {
  std::vector<double> depths;
  for (const DepthReading& reading : readings) depths.push_back(reading.depth_m);
  std::sort(depths.begin(), depths.end());
  double smallest_m = depths.back() - depths.front();
  for (size_t i = 1; i < depths.size(); ++i) {
    const double step_m = depths[i] - depths[i - 1];
    if (step_m > 1e-6) smallest_m = std::min(smallest_m, step_m);
  }
  return smallest_m;
}

/// Longest gap for interpolation: twice the usual step between readings, at
/// least a minute.
double maxGap(const std::vector<DepthReading>& readings) {
  std::vector<double> steps_s;
  for (size_t i = 1; i < readings.size(); ++i) steps_s.push_back(readings[i].time_s - readings[i - 1].time_s);
  return std::max(60.0, 2.0 * median(std::move(steps_s)));
}

/// A log, and the name of its file in an archive.
struct NamedRows {
  ProfileRows rows;
  std::string name;
};

std::string allOf(std::unique_ptr<ByteSource> bytes, const std::string& name) {
  constexpr size_t kMost = size_t{256} << 20, kBlock = 1 << 16;
  std::string text;
  for (size_t got = 1; got > 0;) {
    const size_t before = text.size();
    if (before > kMost) throw InputError(name + ": larger than 256 MB, which no dive log is");
    text.resize(before + kBlock);
    got = bytes->read(text.data() + before, kBlock);
    text.resize(before + got);
  }
  return text;
}

/// A log that is not a table.
std::optional<ProfileRows> readStructured(const std::string& text, const std::string& name,
                                          Diagnostics* diagnostics) {
  if (std::optional<ProfileRows> log = readProfileXml(text, name)) return log;
  return readProfileDl7(text, name, diagnostics);
}

/// The logs of an archive, such as Suunto's (.sde).
std::vector<NamedRows> readArchive(const std::filesystem::path& file, Diagnostics* diagnostics) {
  const ZipArchive archive(file);
  std::vector<NamedRows> logs;
  for (const ZipEntry& entry : archive.entries()) {
    const std::string name = fmt::format("{}: {}", file.string(), entry.name);
    const std::string text = allOf(archive.open(entry), name);
    if (std::optional<ProfileRows> log = readStructured(text, name, diagnostics))
      logs.push_back({std::move(*log), name});
  }
  if (logs.empty()) throw InputError(file.string() + ": an archive without a dive log in XML or DL7");
  return logs;
}

std::vector<NamedRows> readLogs(const std::filesystem::path& file, Diagnostics* diagnostics) {
  const std::string text = allOf(openFile(file), file.string());
  if (text.starts_with("PK\3\4")) return readArchive(file, diagnostics);
  std::optional<ProfileRows> log = readStructured(text, file.string(), diagnostics);
  if (!log) log = readProfileTable(file, diagnostics);
  std::vector<NamedRows> logs;
  logs.push_back({std::move(*log), file.string()});
  return logs;
}

std::string unitName(std::optional<double> metres_per_unit) {
  if (!metres_per_unit) return "no stated unit";
  if (*metres_per_unit == 1.0) return "m";
  return *metres_per_unit == 0.3048 ? "ft" : fmt::format("units of {:g} m", *metres_per_unit);
}

DepthProfile profileOf(const std::vector<ProfileRow>& dive, double metres_per_unit) {
  DepthProfile profile;
  for (const ProfileRow& row : dive) profile.readings.push_back({row.time_s, row.depth * metres_per_unit});
  profile.dive = fmt::format("lines {} to {}", std::min(dive.front().line, dive.back().line),
                             std::max(dive.front().line, dive.back().line));
  profile.resolution_m = resolutionOf(profile.readings);
  profile.max_gap_s = maxGap(profile.readings);
  return profile;
}

}  // namespace

std::vector<DepthProfile> readDepthProfiles(const std::filesystem::path& file, Diagnostics* diagnostics) {
  std::vector<DepthProfile> profiles;
  size_t most = 0, fewest = kFewestReadings;
  int dives_before = 0;
  for (const NamedRows& log : readLogs(file, diagnostics)) {
    const auto passOver = [&](const ProfileRow& row, const std::string& reason) {
      diagnostics->report(Severity::Warning, "profile_line",
                          fmt::format("{}:{}: time {:.6g} s, depth {:.6g}: {}; row passed over", log.name,
                                      row.line, row.time_s, row.depth, reason));
    };
    fewest = log.rows.has_stated_dives ? kFewestOfStatedDive : kFewestReadings;
    most = std::max(most, std::min(log.rows.rows.size(), fewest - 1));
    for (std::vector<ProfileRow>& dive : splitDives(log.rows.rows, log.rows.has_stated_dives, passOver)) {
      screenDepths(&dive, passOver);
      if (dive.size() < fewest) {
        most = dive.size();
        continue;
      }
      profiles.push_back(profileOf(dive, log.rows.metres_per_unit.value_or(1.0)));
      // Without dive numbers in the log, every sequence is a separate dive.
      const auto number = static_cast<size_t>(dive.front().dive);
      profiles.back().dive_number =
          number > 0 ? dives_before + dive.front().dive : -static_cast<int>(profiles.size());
      if (number > 0 && number <= log.rows.dives.size()) profiles.back().label = log.rows.dives[number - 1];
      profiles.back().name = file.filename().string();
      profiles.back().has_unit = log.rows.metres_per_unit.has_value();
      profiles.back().unit = unitName(log.rows.metres_per_unit);
    }
    dives_before += static_cast<int>(log.rows.dives.size());
  }
  if (profiles.empty()) {
    throw InputError(
        fmt::format("{}: only {} usable readings; a depth profile "
                    "takes {} lines of time and depth",
                    file.string(), most, fewest));
  }
  if (profiles.size() == 1) profiles.front().dive.clear();
  return profiles;
}

DepthProfile scaled(DepthProfile profile, double factor) {
  for (DepthReading& reading : profile.readings) reading.depth_m *= factor;
  profile.resolution_m *= factor;
  return profile;
}

}  // namespace lodeline
