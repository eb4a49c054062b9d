#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"

namespace lodeline {

/// A CSV file of a run's output folder, by columns under the names of its header.
struct RunTable {
  std::vector<int64_t> stamp_ns;                       ///< the first column
  std::map<std::string, std::vector<double>> numbers;  ///< nan where the file contains it
  std::map<std::string, std::vector<std::string>> words;

  size_t rows() const { return stamp_ns.size(); }
};

/// Reads a file of StateWriter, TimingWriter or MagnetometerWriter. A column contains words if its first row
/// is not a number. Throws InputError with file and line where the file is missing or has another format. An
/// incomplete last line of a run that was killed is skipped with a warning.
RunTable readRunTable(const std::filesystem::path& file, Diagnostics* diagnostics);

}  // namespace lodeline
