#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/rig_file.h"

namespace lodeline {

/// Path of NAME.rig.yaml for a recording in one file, as NAME.bag or NAME.mp4, or in a folder NAME.
std::filesystem::path rigFileBeside(const std::filesystem::path& recording);

/// The rig of a recording that does not hold one: from `rig_files`, or from the file beside the recording.
/// Without both, throws InputError, or returns an empty rig where no calibration is needed. `kind`: of the
/// recording, e.g. "a bag".
RigFile readRigOf(const std::filesystem::path& recording, const std::string& kind,
                  const std::vector<std::filesystem::path>& rig_files, bool needs_calibration,
                  Diagnostics* diagnostics);

}  // namespace lodeline
