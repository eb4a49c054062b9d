#pragma once

#include <filesystem>

#include "lodeline/simulation/image_recording.h"
#include "lodeline/simulation/scenario.h"

namespace lodeline {

struct RecordingSummary {
  double path_length_m = 0.0;
  double duration_s = 0.0;
  ImageProgress images;
  bool resumed = false;
  bool complete = true;
};

/// Simulates a scenario into a folder: mav0 in the EuRoC layout, truth/ beside it. A folder that holds an
/// unfinished recording of the same scenario is completed; one that holds anything else is refused with
/// InputError. `stage` is told in words what is being done.
RecordingSummary recordScenario(const Scenario& scenario, const std::filesystem::path& folder,
                                const ImageRecordingOptions& options,
                                const std::function<void(const char*)>& stage = {});

}  // namespace lodeline
