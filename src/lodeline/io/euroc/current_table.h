#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/euroc/csv_reader.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Reads current0/data.csv: a stamp and one column for each channel, with its name and unit in the header:
///
///     #timestamp [ns],thruster_1 [A],thruster_2 [A],lamp [mA]
class CurrentTable {
 public:
  /// `channels`: those of the calibration, empty without one. Throws InputError for a file without a header,
  /// a column without a unit of current, and channels that the calibration lacks.
  CurrentTable(const std::filesystem::path& file, const std::vector<std::string>& channels,
               Diagnostics* diagnostics);

  /// Names in the order of the readings: that of the calibration, or of the header without one.
  const std::vector<std::string>& channels() const { return channels_; }
  std::optional<CurrentSample> next();

 private:
  CsvColumns findColumns(const std::vector<ColumnName>& columns);

  std::filesystem::path file_;
  std::vector<std::string> channels_;
  CsvReader reader_;
  CsvRow row_;
};

/// The header of current0/data.csv.
std::string currentHeader(const std::vector<std::string>& channels);

}  // namespace lodeline
