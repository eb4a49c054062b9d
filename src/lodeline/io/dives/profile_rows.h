#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/dives/depth_profile.h"

namespace lodeline {

/// One reading of a dive log, as in the file.
struct ProfileRow {
  double time_s = 0.0;  ///< on the file's own clock; decreases where another dive begins
  double depth = 0.0;   ///< in the file's unit
  int dive = 0;         ///< from 1, in the order of the log; 0 where it states no dives
  int line = 0;         ///< of the file
};

/// All readings of a dive log, in the file's order.
struct ProfileRows {
  std::vector<ProfileRow> rows;
  std::optional<double> metres_per_unit;  ///< of the depths; empty where the file states no unit
  std::vector<DiveLabel> dives;           ///< of the numbers in ProfileRow::dive
  /// Whether the log is not a table: then nothing but its dives divides the
  /// rows.
  bool has_stated_dives = false;
};

/// Reads a table (tables/table_reader.h) whose header names columns of time and
/// depth, in any order among others. Columns of other depths (average, maximum,
/// stop, ceiling) and other times are never used. Times are numbers, m:ss,
/// h:mm:ss or dates. Units are in the header, in a line below it, or in lines
/// before it
/// ("Imperial Units", "Log interval: 5 s"). Without a header the first two
/// columns are time and depth. Rows that cannot be read are reported and
/// skipped. Throws InputError where the columns are unclear, or where a stated
/// unit is unknown.
ProfileRows readProfileTable(const std::filesystem::path& file, Diagnostics* diagnostics);

/// Reads a log in XML of Subsurface (.ssrf, .xml), UDDF, divelogs (UDCF) and
/// Suunto (SDM, DM4, DM5); empty where the text does not start as XML. `name`
/// is for messages. Throws InputError where it is XML of another kind, is
/// damaged (with the line), or declares entities.
std::optional<ProfileRows> readProfileXml(const std::string& text, const std::string& name);

/// Reads a DL7 log of the Divers Alert Network (.zxu, .zxl; DAN, "DL7
/// Standard", 2006); empty where the text does not start as one. Times are
/// minutes, or seconds where only they fit the stated end of the dive. Throws
/// InputError where it states no known unit of depth, or a row is malformed
/// (with the line).
std::optional<ProfileRows> readProfileDl7(const std::string& text, const std::string& name,
                                          Diagnostics* diagnostics);

}  // namespace lodeline
