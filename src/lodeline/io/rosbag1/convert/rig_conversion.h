#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/euroc/euroc_rig.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Writes the calibration of a recording in the EuRoC ASL layout, from its sensor.yaml or Kalibr files, as
/// one rig file, numbers letter by letter. `topics`: by sensor. Masks are copied beside it.
void writeRigFile(const EurocLayout& layout, const std::map<std::string, std::string>& topics,
                  const std::filesystem::path& file);

/// Writes a rig file's sections as sensor.yaml files into `folder`/mav0, those of Kalibr as his files into
/// `folder`, numbers letter by letter. Masks are copied.
void writeFolderCalibration(const RigFile& rig_file, const std::filesystem::path& folder);

}  // namespace lodeline
