#pragma once

#include <string>

#include "lodeline/io/calibration/rig_file.h"

namespace lodeline {

/// A rig file (see readRigFiles) that says what `rig` holds, numbers with all their digits, and comments on
/// the keys. Cameras without extrinsics get a line to fill in instead of `T_BS`, without which the file is
/// refused.
std::string rigText(const RigFile& rig);

/// A rig file to fill in: one camera pair, an IMU and the sensors that may be there, with what each key
/// means.
std::string rigTemplate();

}  // namespace lodeline
