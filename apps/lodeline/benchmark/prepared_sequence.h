#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/lodeline/benchmark/benchmark_set.h"
#include "apps/lodeline/benchmark/set_folder.h"

namespace lodeline {

/// A sequence of a set as `lodeline batch` takes it.
struct PreparedSequence {
  const SetSequence* sequence = nullptr;
  std::string data;                    ///< empty where it cannot be run
  std::string truth;                   ///< TUM layout, body in world; empty where there is none
  std::vector<std::string> arguments;  ///< of `lodeline run`
  std::string problem;                 ///< why it cannot be run or compared; empty where it can
};

/// Finds a sequence in a set and makes what it lacks in `folder`: links to its files, a calibration, the
/// truth as poses of the body. Empty where nothing of the sequence is there. Faults end in `problem`; throws
/// InputError only where `folder` cannot be written.
std::optional<PreparedSequence> prepareSequence(const BenchmarkSet& set, const SetSequence& sequence,
                                                const SetFolder& files, const std::filesystem::path& folder);

}  // namespace lodeline
