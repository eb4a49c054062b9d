#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// One of the CSV files of a run's output folder, column by column under the names of its header.
struct RunTable {
  std::vector<int64_t> stamp_ns;                       ///< the first column
  std::map<std::string, std::vector<double>> numbers;  ///< nan where the file says so
  std::map<std::string, std::vector<std::string>> words;

  size_t rows() const { return stamp_ns.size(); }
};

/// Reads a file that StateWriter, TimingWriter or MagnetometerWriter wrote. A column is words where its first
/// row is no number. Throws InputError, naming file and line, where the file is missing or is none of these;
/// a last line that was cut off by the end of a run is passed over with a warning.
RunTable readRunTable(const std::filesystem::path& file, Diagnostics* diagnostics);

}  // namespace lodeline
