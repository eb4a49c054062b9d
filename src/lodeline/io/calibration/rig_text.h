#pragma once

#include <string>

#include "lodeline/io/calibration/rig_file.h"

namespace lodeline {

/// Text of a rig file (see readRigFiles) for `rig`, with all digits of the numbers and comments on the keys.
/// A camera without extrinsics gets a line to fill in instead of `T_BS`; readers refuse the file until then.
std::string rigText(const RigFile& rig);

/// Template of a rig file: two cameras, an IMU and the optional sensors, with the meaning of each key.
std::string rigTemplate();

}  // namespace lodeline
