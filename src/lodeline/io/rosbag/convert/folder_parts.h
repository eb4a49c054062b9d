#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/convert/convert.h"

namespace lodeline {

/// Options that read all parts of a folder that is converted; a recording may have only inertial and magnetic
/// readings.
EurocOptions everythingIn(const std::filesystem::path& folder, const ConvertOptions& options);

/// Copies the tables in `mav0` that hold no readings of a sensor, such as true states or positions by a total
/// station: header and sensor.yaml, and the rows that `contains` accepts by their stamps in nanoseconds,
/// letter by letter. Counts the rows by the name of the table. Tables without such stamps are left out
/// (`convert_left_out`).
void copyOtherTables(const std::filesystem::path& mav0, const std::filesystem::path& target,
                     const std::function<bool(Time)>& contains, std::map<std::string, int>* rows,
                     Diagnostics* diagnostics);

}  // namespace lodeline
