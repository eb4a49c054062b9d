#pragma once

#include <optional>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/output/survey/depth/depth_alignment.h"

namespace lodeline {

/// A profile and its alignment with the run.
struct ProfileFit {
  DepthProfile profile;
  DepthAlignment alignment;
};

/// Chooses the dive of a log that fits the run, aligned with it (alignDepths). If the log states no unit and
/// its depths fit only in feet, centimetres or millimetres, that unit is used and reported. The alignment is
/// marked as doubtful if the log states another unit, or if several dives fit equally well. Throws InputError
/// where no dive has time in common with the run.
ProfileFit fitProfile(const std::vector<DepthProfile>& dives, const Trajectory& trajectory,
                      std::optional<double> known_lag_s, Diagnostics* diagnostics);

}  // namespace lodeline
