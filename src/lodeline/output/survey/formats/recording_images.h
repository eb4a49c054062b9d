#pragma once

#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/formats/map_files.h"
#include "lodeline/recording.h"

namespace lodeline {

/// The cameras of a rig with the corrections of extrinsics and lenses that a run estimated.
std::vector<CameraCalibration> camerasOfRun(const Rig& rig, const RunFolder& run);

/// Assigns the images of a recording to poses (within 5 ms). Image names start at the recording's camera
/// folder (cam0/data/STAMP.png; those of a bag as `lodeline convert` writes them). The cameras are
/// camerasOfRun(). Reads the lists of images to their end and decodes
/// none.
MapImages recordingImages(MeasurementSource& source, const RunFolder& run, Diagnostics* diagnostics);

}  // namespace lodeline
