#pragma once

#include <string>
#include <vector>

#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"

namespace lodeline {

/// The place that words of the command line name: latitude and longitude in degrees, height in m, between
/// them commas, semicolons or blanks ("29.83,-82.6,10", "29.83 -82.6 10"). `option` is for messages. Throws
/// UsageError for anything else.
GeodeticPosition placeFromWords(const std::vector<std::string>& words, const std::string& option);

}  // namespace lodeline
