#pragma once

#include <string>
#include <vector>

#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"

namespace lodeline {

/// Position from words of the command line: latitude and longitude in degrees, height in m, separated by
/// commas, semicolons or blanks ("29.83,-82.6,10", "29.83 -82.6 10"). `option` is for messages. Throws
/// UsageError for anything else.
GeodeticPosition placeFromWords(const std::vector<std::string>& words, const std::string& option);

}  // namespace lodeline
