#pragma once

#include <filesystem>

#include "lodeline/simulation.h"

namespace lodeline {

struct SimulationRun {
  int threads = 0;     ///< for rendering; 0 for all cores
  bool quiet = false;  ///< no progress on the terminal
};

/// Simulates a scenario into a folder with a progress display, or continues an interrupted simulation. Ctrl-C
/// ends it early (RecordingSummary::complete is false then). Throws as recordScenario() does.
RecordingSummary simulateRecording(const Scenario& scenario, const std::filesystem::path& folder,
                                   const SimulationRun& run);

}  // namespace lodeline
