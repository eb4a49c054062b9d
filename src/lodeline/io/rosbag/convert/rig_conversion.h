#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/euroc/euroc_rig.h"

namespace lodeline {

/// The rig with its cameras numbered from 0 on in the order of `cameras`, their numbers so far. Other cameras
/// are left out; with an empty list nothing changes.
RigFile numberedRig(RigFile rig, const std::vector<int>& cameras);

/// Writes the calibration of a recording in the EuRoC ASL layout (sensor.yaml or Kalibr files) as one rig
/// file. Numbers are copied digit by digit. `topics`: by sensor. Masks are copied to the folder of the rig
/// file.
void writeRigFile(const EurocLayout& layout, const std::map<std::string, std::string>& topics,
                  const std::filesystem::path& file);

/// Writes the sections of rig files as one rig file. `topics`: by sensor, with priority over those in the
/// files.
void writeRigFile(const RigFile& rig, const std::map<std::string, std::string>& topics,
                  const std::filesystem::path& file);

/// Writes the sections of a rig file as sensor.yaml files in `folder`/mav0, and Kalibr's sections as Kalibr's
/// files in `folder`. Numbers are copied digit by digit. Masks are copied.
void writeFolderCalibration(const RigFile& rig_file, const std::filesystem::path& folder);

}  // namespace lodeline
