#pragma once

#include <filesystem>

#include "lodeline/pipeline/run_recording.h"
#include "lodeline/trajectory.h"

namespace lodeline {

/// Corrects a finished trajectory with the magnetometer of its recording (correctHeadingByAzimuth) and writes
/// it to `folder` as trajectory.tum. North is true north where the request contains site and date, else
/// magnetic north. Throws InputError where the recording has no calibrated magnetometer or no reading.
Trajectory makeAzimuthRun(const RunRequest& request, const Trajectory& odometry,
                          const std::filesystem::path& folder);

}  // namespace lodeline
