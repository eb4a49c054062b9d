#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/output/survey/profile/depth_profile.h"
#include "lodeline/output/survey/run/run_folder.h"

namespace lodeline {

/// How a depth profile and the vertical of a run fit: profile time + lag = run time, and
/// profile depth = start depth - z of the run.
struct DepthAlignment {
  double lag_s = 0.0;
  double lag_sigma_s = 0.0;
  double start_depth_m = 0.0;  ///< of the world's origin, the first pose; median over the common time
  double rms_m = 0.0;          ///< of the differences from that
  double slope = 1.0;  ///< metres of the profile per metre of the run, where the depths range widely enough
  double common_s = 0.0;  ///< time for which both are there
  /// Why lag or depths may be wrong, in words; empty where there is no doubt.
  std::string doubt;
};

/// Finds the lag at which the profile's course is most like the run's: least mean absolute deviation from the
/// median difference, the worst tenth left out, over all lags at which 80 % of the shorter of both overlap;
/// then finely around the best. `known_lag_s` takes the place of the search.
/// Doubted are lags that are known badly, and profiles that do not change as the run does. Throws InputError
/// where there is no overlap.
DepthAlignment alignDepths(const DepthProfile& profile, const Trajectory& trajectory,
                           std::optional<double> known_lag_s);

/// One instant of both.
struct DepthComparison {
  Time time;
  double run_depth_m = 0.0;  ///< start depth - z
  double profile_depth_m = 0.0;
};
/// For every pose that the profile covers.
std::vector<DepthComparison> compareDepths(const DepthProfile& profile, const Trajectory& trajectory,
                                           const DepthAlignment& alignment);

/// Moves the run up and down onto the profile: the differences, smoothed (a running median, then a running
/// mean, of 20 s each), are added to the depths; the run keeps its detail and the profile gives the level.
/// Where the profile has ended, its last difference stands. Landmarks move with the nearest pose. The first
/// pose stays the origin; gives its depth below the surface. The vertical's uncertainty becomes that of the
/// profile.
double correctDepths(const DepthProfile& profile, const DepthAlignment& alignment, RunFolder* run);

}  // namespace lodeline
