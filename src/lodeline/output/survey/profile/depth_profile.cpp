#include "lodeline/output/survey/profile/depth_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/profile/profile_rows.h"
#include "lodeline/output/survey/profile/profile_screen.h"

namespace lodeline {
namespace {

constexpr size_t kFewestReadings = 10;

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

/// Longest gap for interpolation: twice the usual step between readings, at least a minute.
double maxGap(const std::vector<DepthReading>& readings) {
  std::vector<double> steps_s;
  for (size_t i = 1; i < readings.size(); ++i) steps_s.push_back(readings[i].time_s - readings[i - 1].time_s);
  const auto middle = steps_s.begin() + static_cast<std::ptrdiff_t>(steps_s.size() / 2);
  std::nth_element(steps_s.begin(), middle, steps_s.end());
  return std::max(60.0, 2.0 * *middle);
}

/// Throws for DL7, the format of the Divers Alert Network, which few programs read.
void refuseDl7(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  char head[4] = {};
  stream.read(head, 3);
  if (std::string_view(head) != "FSH" && std::string_view(head) != "ZRH") return;
  throw InputError(file.string() +
                   ": a DL7 log (DAN); import it into Subsurface and export the dive as 'CSV dive profile'");
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
  refuseDl7(file);
  std::optional<ProfileRows> log = readProfileXml(file);
  if (!log) log = readProfileTable(file, diagnostics);
  const auto passOver = [&](const ProfileRow& row, const std::string& reason) {
    diagnostics->report(Severity::Warning, "profile_line",
                        fmt::format("{}:{}: time {:.6g} s, depth {:.6g}: {}; row passed over", file.string(),
                                    row.line, row.time_s, row.depth, reason));
  };
  std::vector<DepthProfile> profiles;
  size_t most = std::min(log->rows.size(), kFewestReadings - 1);
  for (std::vector<ProfileRow>& dive : splitDives(log->rows, passOver)) {
    screenDepths(&dive, passOver);
    if (dive.size() < kFewestReadings) {
      most = dive.size();
      continue;
    }
    profiles.push_back(profileOf(dive, log->metres_per_unit.value_or(1.0)));
    // Without dive numbers in the log, every sequence is a separate dive.
    profiles.back().dive_number =
        dive.front().dive > 0 ? dive.front().dive : -static_cast<int>(profiles.size());
    profiles.back().name = file.filename().string();
    profiles.back().has_unit = log->metres_per_unit.has_value();
  }
  if (profiles.empty()) {
    throw InputError(
        fmt::format("{}: only {} usable readings; a depth profile takes {} lines of time and depth",
                    file.string(), most, kFewestReadings));
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
