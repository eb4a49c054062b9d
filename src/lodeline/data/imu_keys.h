#pragma once

#include "lodeline/data/yaml_file.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// Reads the four noise densities that EuRoC and Kalibr name alike. Throws InputError where one is missing or
/// not positive.
ImuNoise readImuNoise(CalibrationMap* map);

}  // namespace lodeline
