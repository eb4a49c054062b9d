#pragma once

#include <vector>

#include "lodeline/mapping/recognition/verification/descriptor_matcher.h"
#include "lodeline/mapping/recognition/verification/loop_geometry.h"
#include "lodeline/mapping/recognition/verification/view_grid.h"

namespace lodeline {

/// log10 of the expected number of poses to which chance alone gives `agreeing` of `tried` independent trials
/// or more. A trial agrees with probability `chance`, and two trials make a pose:
///
///     (tried - 2) * 4 * C(tried, agreeing) * C(agreeing, 2) * chance^(agreeing - 2).
///
/// The factor 4 counts the poses of one sample: two solutions, in two directions. (L. Moisan and B. Stival,
/// "A probabilistic criterion to detect rigid point matches", IJCV 2004.)
double log10FalseAlarms(int tried, int agreeing, double chance);

/// Evidence that a set of inliers is no accident.
struct Evidence {
  int cells = 0;               ///< that contain inliers, in the view with fewer
  double covered_share = 0.0;  ///< of the view, by these
  double chance = 0.0;         ///< that a wrong match is an inlier
  double log10_false_alarms = 0.0;
};

/// Evidence for a pose. The trials are the cells of a view that contain matches, because errors of
/// neighbouring matches depend on each other: one look-alike object makes many inliers, but in few cells. The
/// less favourable of both views counts.
///
/// `pairs` and `searched_rad` describe the matches, `is_inlier` which of them agree with `old_from_new`.
Evidence evidenceFor(const std::vector<LoopCorrespondence>& pairs, const std::vector<double>& searched_rad,
                     const std::vector<bool>& is_inlier, const Rigid3& old_from_new, const ViewGrid& old_view,
                     const ViewGrid& new_view);

}  // namespace lodeline
