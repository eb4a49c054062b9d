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

/// Simulates a scenario into a folder: mav0 in the EuRoC layout, and truth/. A folder with an unfinished
/// recording of the same scenario is completed. Throws InputError where the folder has any other content.
/// `stage` receives a description of each step.
RecordingSummary recordScenario(const Scenario& scenario, const std::filesystem::path& folder,
                                const ImageRecordingOptions& options,
                                const std::function<void(const char*)>& stage = {});

/// Writes the recording of `scenario` in `original` to `folder` with other sensor noise
/// (Scenario::noise_seed). It writes the readings of IMU, magnetometer and pressure sensor and the true
/// biases; images and sonar are links to the original. Throws InputError where `original` has another
/// recording, or `folder` is not empty.
void recordOtherNoise(const Scenario& scenario, const std::filesystem::path& original,
                      const std::filesystem::path& folder);

/// Whether the folder has a recording of this scenario, complete or not.
bool holdsRecording(const Scenario& scenario, const std::filesystem::path& folder);

}  // namespace lodeline
