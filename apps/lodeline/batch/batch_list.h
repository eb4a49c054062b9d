#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/trajectory.h"

namespace lodeline {

/// One run of a batch: a recording, a variant of the settings, and a seed.
struct BatchItem {
  std::string name;       ///< unique: RECORDING.VARIANT or RECORDING.VARIANT.SEED
  std::string recording;  ///< name of the recording
  std::string variant;    ///< name of the variant
  std::optional<int> seed;
  std::string data;                    ///< recording as the list names it; empty where it is simulated
  std::vector<std::string> simulate;   ///< words after `lodeline simulate`, without -o; else empty
  std::string simulated_name;          ///< name of the folder of the simulated recording
  std::string truth;                   ///< ground truth as the list names it; empty for none
  std::vector<std::string> arguments;  ///< words after `lodeline run`, without recording and -o
};

/// A list of runs.
struct BatchList {
  std::filesystem::path folder;  ///< absolute folder of the list; relative paths in the list start here
  AlignmentType alignment = AlignmentType::SE3;
  std::optional<double> tolerance_s;  ///< greatest difference in time from a pose of the ground truth
  std::vector<BatchItem> items;       ///< recordings × variants × seeds, in the order of the list
};

/// Reads a list of runs. Throws UsageError with file and line for an unknown key and for a missing or
/// repeated name. The same holds for a missing file and an unknown setting of `lodeline run`.
BatchList readBatchList(const std::filesystem::path& file);

/// A part of a batch, for jobs on several machines.
struct BatchShard {
  size_t index = 0;  ///< from 0
  size_t count = 1;

  bool contains(size_t item) const { return item % count == index; }
};

/// Shard from "I/N" with I from 1 to N. Throws UsageError.
BatchShard batchShardFromText(const std::string& text);

}  // namespace lodeline
