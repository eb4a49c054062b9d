#pragma once

#include <filesystem>

#include "simulation/dive/dive.h"
#include "simulation/sensors/sonar_model.h"

namespace lodeline {

/// Writes everything except images, camera lists and truth/: the given calibration and the readings of imu0,
/// mag0, pressure0, sonar0, and a vehicle's altimeter0, dvl0 and current0 into folder/mav0. The true states
/// go into mav0/state_groundtruth_estimate0 (EuRoC's columns, body in W, IMU clock, 100 Hz; 1 Hz at rest). An
/// empty `range` means no sonar, altimeter and DVL. Cameras are left out where the scenario has no images.
/// Throws InputError where a file cannot be written.
void recordSensors(const Dive& dive, const RangeFunction& range, const std::filesystem::path& folder);

}  // namespace lodeline
