#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lodeline/base/diagnostics.h"

namespace lodeline {

struct DepthReading {
  double time_s = 0.0;   ///< on the profile's own clock
  double depth_m = 0.0;  ///< below the surface, positive down
};

/// Depth over time from a dive computer or a diver's slate, strictly increasing in time.
struct DepthProfile {
  std::string name;  ///< of the file
  std::vector<DepthReading> readings;
  double resolution_m = 0.0;  ///< smallest step between different depths that occur
};

/// Reads a CSV file (commas, semicolons, tabs; a decimal comma with semicolons). A header names the columns
/// by the words `time`, `elapsed`, `timestamp`, `t` or `date`, and `depth` (those of each `sample` first);
/// units stand in brackets or follow the name: s, min, ms, ns; m, ft. Without a header the first two columns
/// are time and depth. Times are numbers, mm:ss, h:mm:ss, or dates in ISO 8601 (UTC unless they end in an
/// offset). Without a unit, times are seconds (numbers beyond 1e15: nanoseconds), depths metres. Depths that
/// are nowhere positive are heights. Lines that cannot be read are reported and passed over. Throws
/// InputError where the file is missing, no columns can be told, or fewer than 10 readings are usable.
DepthProfile readDepthProfile(const std::filesystem::path& file, Diagnostics* diagnostics);

}  // namespace lodeline
