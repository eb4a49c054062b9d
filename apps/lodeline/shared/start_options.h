#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <vector>

#include "lodeline/mapping/session/dive_start.h"

namespace lodeline {

/// `--start` and `--start-sigma`: where a dive began in a map.
struct StartArguments {
  std::vector<double> position_m;             ///< east, north, up; empty where it is not known
  std::vector<double> sigmas_m = {3.0, 1.0};  ///< horizontal, vertical

  /// Throws UsageError for numbers that are not finite, or sigmas that are not positive.
  std::optional<DiveStart> start() const;
};

/// Returns the option `--start`.
CLI::Option* addStartOptions(StartArguments* arguments, CLI::App* command);

}  // namespace lodeline
