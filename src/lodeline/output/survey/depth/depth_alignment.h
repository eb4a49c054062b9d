#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/dives/depth_profile.h"
#include "lodeline/survey.h"

namespace lodeline {

/// Alignment of a depth profile with the vertical of a run: profile time + lag = run time, and profile depth
/// = start depth - z of the run.
struct DepthAlignment {
  double lag_s = 0.0;
  double lag_sigma_s = 0.0;
  double start_depth_m = 0.0;  ///< of the world's origin, the first pose; median over the common time
  double rms_m = 0.0;          ///< of the differences from this relation
  double slope = 1.0;  ///< metres of the profile per metre of the run, if the range of depths is large enough
  double common_s = 0.0;  ///< duration of the overlap
  /// Reason why lag or depths may be wrong, in words; empty where there is no doubt.
  std::string doubt;
};

/// Finds the lag with the best agreement between profile and run: smallest mean absolute deviation from the
/// median difference, without the worst tenth, over all lags at which 80 % of the shorter of both overlap;
/// then a fine search around the best. `known_lag_s` replaces the search. Doubtful are lags with a large
/// sigma, and profiles that do not change like the run. Throws InputError where there is no overlap.
DepthAlignment alignDepths(const DepthProfile& profile, const Trajectory& trajectory,
                           std::optional<double> known_lag_s);

/// Depths of both at one time.
struct DepthComparison {
  Time time;
  double run_depth_m = 0.0;  ///< start depth - z
  double profile_depth_m = 0.0;
};
/// One comparison for every pose within the profile's time.
std::vector<DepthComparison> compareDepths(const DepthProfile& profile, const Trajectory& trajectory,
                                           const DepthAlignment& alignment);

/// Corrects the depths of the run by the profile: the smoothed differences (a running median, then a running
/// mean, of 20 s each) are added to the depths. The run keeps its detail and gets the level of the profile.
/// After the end of the profile, its last difference remains. Landmarks move with the nearest pose. The first
/// pose stays the origin; returns its depth below the surface. The uncertainty of the vertical becomes that
/// of the profile.
double correctDepths(const DepthProfile& profile, const DepthAlignment& alignment, RunFolder* run);

}  // namespace lodeline
