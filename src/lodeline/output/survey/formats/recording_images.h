#pragma once

#include "lodeline/io/synchronizer/measurement_source.h"
#include "lodeline/output/survey/formats/map_files.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Which images of a recording belong to which poses (within 5 ms), named from the recording's camera folder
/// on (cam0/data/STAMP.png; those of a bag as `lodeline convert` writes them), and its cameras as the run
/// left them: with the corrections that it estimated to their extrinsics. Reads the lists of images to their
/// end; decodes none.
MapImages recordingImages(MeasurementSource& source, const RunFolder& run, Diagnostics* diagnostics);

}  // namespace lodeline
