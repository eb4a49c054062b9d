#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"

namespace lodeline {

/// One reading of a dive log, as in the file.
struct ProfileRow {
  double time_s = 0.0;  ///< on the file's own clock; decreases where another dive begins
  double depth = 0.0;   ///< in the file's unit
  int dive = 0;         ///< rows with different numbers belong to different dives
  int line = 0;         ///< of the file
};

/// All readings of a dive log, in the file's order.
struct ProfileRows {
  std::vector<ProfileRow> rows;
  std::optional<double> metres_per_unit;  ///< of the depths; empty where the file states no unit
};

/// Reads a table (tables/table_reader.h) whose header names columns of time and depth, in any order among
/// others. Columns of other depths (average, maximum, stop, ceiling) and other times are never used. Times
/// are numbers, m:ss, h:mm:ss or dates. Units are in the header, in a line below it, or in lines before it
/// ("Imperial Units", "Log interval: 5 s"). Without a header the first two columns are time and depth. Rows
/// that cannot be read are reported and skipped. Throws InputError where the columns are unclear, or where a
/// stated unit is unknown.
ProfileRows readProfileTable(const std::filesystem::path& file, Diagnostics* diagnostics);

/// Reads a log in XML of Subsurface (.ssrf, .xml), UDDF and divelogs (UDCF); empty where the file does not
/// start as XML. Throws InputError where it is XML of another kind, or damaged.
std::optional<ProfileRows> readProfileXml(const std::filesystem::path& file);

}  // namespace lodeline
