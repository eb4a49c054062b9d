#pragma once

#include <vector>

#include "lodeline/output/survey/map/survey.h"

namespace lodeline {

struct LoopOptions {
  /// A station is no revisit of what lies less way than this behind it.
  double least_length_m = 15.0;
  /// How far from his own line of before a diver swims, one sigma per axis: stations are where the rig was,
  /// not marks on a wall.
  double swim_sigma_m = 0.5;
  /// Greatest Mahalanobis distance squared of a revisit: 95 % of chi-squared with three degrees of freedom.
  double most_squared = 7.815;
};

/// Consecutive stations that come back to an earlier part of the line, as far as the uncertainties tell.
struct LoopCandidate {
  size_t first = 0, last = 0;  ///< the stations
  /// Of the station among them that closes the longest loop: the leg it comes back to begins at `leg`.
  size_t station = 0, leg = 0;
  Vec3 misclosure_ENU = Vec3::Zero();  ///< m, from that leg to the station
  Vec3 sigma_ENU = Vec3::Zero();       ///< m, one sigma of it
  double length_m = 0.0;               ///< of the loop along the line
  double median_misclosure_m = 0.0;    ///< over all stations of the candidate

  double percent() const { return length_m > 0.0 ? 100.0 * misclosure_ENU.norm() / length_m : 0.0; }
};

/// Where the line comes near to itself: for every station the nearest point of the line at least
/// `least_length_m` of way before it is looked for; the offset must be no greater than its uncertainty
/// allows, that of the legs in between, taken for independent, and of the swimmer's place. Nobody has seen
/// that these are the same places, so nothing may be equated on their account. Longest loop first.
std::vector<LoopCandidate> findLoopCandidates(const Survey& survey, const LoopOptions& options = {});

}  // namespace lodeline
