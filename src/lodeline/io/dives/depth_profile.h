#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"

namespace lodeline {

/// A dive as its log names it.
struct DiveLabel {
  std::string number;  ///< in the log; empty where it has none
  std::string start;   ///< "YYYY-MM-DD HH:MM:SS" on the clock of the dive
                       ///< computer; may be empty
};

struct DepthReading {
  double time_s = 0.0;   ///< on the profile's own clock
  double depth_m = 0.0;  ///< below the surface, positive down
};

/// Depth over time of one dive from a dive computer or a diver's slate,
/// strictly increasing in time.
struct DepthProfile {
  std::string name;  ///< of the file
  std::string dive;  ///< name of the dive in the file ("lines 3 to 70"); empty
                     ///< where there is one
  DiveLabel label;
  int dive_number = 0;  ///< the same for recordings of one dive by several computers
  std::vector<DepthReading> readings;
  double resolution_m = 0.0;  ///< smallest step between different depths
  double max_gap_s = 60.0;    ///< longest gap between readings over which depths
                              ///< may be interpolated
  bool has_unit = true;       ///< false where the file states no unit: depths count as metres
  std::string unit = "m";     ///< of the depths in the file, for messages
};

/// Reads the dives of a log: a table, XML or DL7 (profile_rows.h), or a zip archive of such files. Rows that
/// cannot be read or are impossible (profile_screen.h) are reported and skipped. Throws InputError for a
/// missing file, a file that is no readable log, and an unknown unit. A dive needs 10 usable readings (3 in a
/// log that says where each dive begins).
std::vector<DepthProfile> readDepthProfiles(const std::filesystem::path& file, Diagnostics* diagnostics);

/// The same dive with every depth multiplied.
DepthProfile scaled(DepthProfile profile, double factor);

}  // namespace lodeline
