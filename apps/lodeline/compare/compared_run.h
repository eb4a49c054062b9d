#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/lodeline/compare/comparison_input.h"
#include "lodeline/evaluation/errors/comparison.h"

namespace lodeline {

/// Whether `name` is a method of `lodeline compare`. "off", "paper" and "absolute" are models of the
/// magnetometer in the window. "azimuth" is the finished "off" trajectory corrected by
/// correctHeadingByAzimuth().
bool isComparedMethod(const std::string& name);

/// Makes one run of a method in its folder and evaluates it with the recording's ground truth. An existing
/// run from the same recording, settings, calibration and program is not repeated. The reason for a failed
/// run is in `failure`. Empty where the user stopped it. `input_folder`: the results of this recording, one
/// folder per method and seed.
std::optional<ComparedRun> makeComparedRun(const ComparisonInput& input, const ComparisonSeed& seed,
                                           const std::string& method,
                                           const std::filesystem::path& input_folder,
                                           const Trajectory& truth);

}  // namespace lodeline
