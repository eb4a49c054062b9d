#pragma once

#include <filesystem>

#include "simulation/dive/image_recording.h"
#include "simulation/dive/scenario.h"

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

/// The recording of `scenario` in `original` once more, with another noise of its sensors
/// (Scenario::noise_seed) in `folder`: readings of IMU, magnetometer and pressure sensor and the truth's
/// biases are written, images and sonar are links to the original's. Throws InputError where `original` holds
/// another recording, or `folder` anything else.
void recordOtherNoise(const Scenario& scenario, const std::filesystem::path& original,
                      const std::filesystem::path& folder);

/// Whether the folder holds a recording of this scenario, perhaps unfinished.
bool holdsRecording(const Scenario& scenario, const std::filesystem::path& folder);

}  // namespace lodeline
