#pragma once

#include "lodeline/mapping/control/files/control_set.h"

namespace lodeline {

/// Reads control points from a table with named columns: `name`; `kind`; `latitude`, `longitude`, `height`,
/// or `easting`, `northing`, `altitude`, or `east`, `north`, `up` (m in the map frame); `horizontal sigma`,
/// `vertical sigma`; `tag`; `time`; `dive`.
ControlSet readControlTable(const std::filesystem::path& file, const ControlReadOptions& options,
                            Diagnostics* diagnostics);

}  // namespace lodeline
