#include "lodeline/io/dives/dive_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

/// One dive, which several computers may have recorded.
struct Dive {
  int id = 0;          ///< DepthProfile::dive_number
  std::string number;  ///< for the user
  std::string start;
  double duration_min = 0.0;
  double depth_m = 0.0;  ///< greatest
};

std::vector<Dive> divesOf(const std::vector<DepthProfile>& profiles) {
  std::vector<Dive> dives;
  std::set<std::string> numbers;
  for (const DepthProfile& profile : profiles) {
    if (dives.empty() || dives.back().id != profile.dive_number) {
      dives.push_back({profile.dive_number, profile.label.number, profile.label.start, 0.0, 0.0});
      numbers.insert(profile.label.number);
    }
    Dive& dive = dives.back();
    for (const DepthReading& reading : profile.readings)
      dive.depth_m = std::max(dive.depth_m, reading.depth_m);
    const double duration_s = profile.readings.back().time_s - profile.readings.front().time_s;
    dive.duration_min = std::max(dive.duration_min, duration_s / 60.0);
  }
  // Numbers that are missing or not unique identify no dive.
  const bool are_numbered = numbers.size() == dives.size() && numbers.count("") == 0;
  for (size_t i = 0; i < dives.size() && !are_numbered; ++i) dives[i].number = std::to_string(i + 1);
  return dives;
}

std::string listOf(const std::vector<Dive>& dives) {
  std::string text;
  for (const Dive& dive : dives) {
    text += fmt::format("\n  --dive {:<6} {:<19} {:>5.0f} min {:>6.1f} m", dive.number,
                        dive.start.empty() ? "no date" : dive.start, dive.duration_min, dive.depth_m);
  }
  return text;
}

std::string withBlank(std::string date) {
  if (date.size() > 10 && date[10] == 'T') date[10] = ' ';
  return date;
}

}  // namespace

std::vector<DepthProfile> chooseDive(const std::vector<DepthProfile>& profiles, const std::string& choice) {
  const std::vector<Dive> dives = divesOf(profiles);
  const std::string name = profiles.empty() ? "" : profiles.front().name;
  if (choice.empty() && dives.size() > 1) {
    throw InputError(fmt::format("{} has {} dives; choose one by its number or the start of its date:{}",
                                 name, dives.size(), listOf(dives)));
  }
  std::vector<int> chosen;
  const std::string date = withBlank(choice);
  for (const Dive& dive : dives) {
    const bool is_date = date.find('-') != std::string::npos && dive.start.starts_with(date);
    if (choice.empty() || dive.number == choice || is_date) chosen.push_back(dive.id);
  }
  if (chosen.size() != 1) {
    throw UsageError(fmt::format("--dive {}: {} has {} such dives; it has:{}", choice, name, chosen.size(),
                                 listOf(dives)));
  }
  std::vector<DepthProfile> result;
  for (const DepthProfile& profile : profiles) {
    if (profile.dive_number == chosen.front()) result.push_back(profile);
  }
  return result;
}

}  // namespace lodeline
