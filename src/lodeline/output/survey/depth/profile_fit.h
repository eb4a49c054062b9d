#pragma once

#include <optional>
#include <vector>

#include "lodeline/output/survey/depth/depth_alignment.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// A profile and how it fits the run.
struct ProfileFit {
  DepthProfile profile;
  DepthAlignment alignment;
};

/// The dive of a log that fits the run, aligned with it (alignDepths). Where the log states no unit and its
/// depths fit only in feet, centimetres or millimetres, that unit is taken and reported; where it states
/// another, or where several dives fit alike, the alignment is doubted. Throws InputError where no dive has
/// time in common with the run.
ProfileFit fitProfile(const std::vector<DepthProfile>& dives, const Trajectory& trajectory,
                      std::optional<double> known_lag_s, Diagnostics* diagnostics);

}  // namespace lodeline
