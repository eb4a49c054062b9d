#pragma once

#include <vector>

#include "lodeline/output/survey/map/survey.h"

namespace lodeline {

struct LoopOptions {
  /// A revisit must be at least this length of the line after the revisited point.
  double least_length_m = 15.0;
  /// Distance of a diver from his earlier line, one sigma per axis: stations are positions of the rig, not
  /// marks on a wall.
  double swim_sigma_m = 0.5;
  /// Largest squared Mahalanobis distance of a revisit: 95 % of chi-squared with three degrees of freedom.
  double most_squared = 7.815;
};

/// Consecutive stations that may return to an earlier part of the line, within the uncertainties.
struct LoopCandidate {
  size_t first = 0, last = 0;  ///< the stations
  /// The station among them that closes the longest loop, and the index of the first station of the leg it
  /// returns to.
  size_t station = 0, leg = 0;
  Vec3 misclosure_ENU = Vec3::Zero();  ///< m, from that leg to the station
  Vec3 sigma_ENU = Vec3::Zero();       ///< m, one sigma of it
  double length_m = 0.0;               ///< of the loop along the line
  double median_misclosure_m = 0.0;    ///< over all stations of the candidate

  double percent() const { return length_m > 0.0 ? 100.0 * misclosure_ENU.norm() / length_m : 0.0; }
};

/// Finds places where the line returns close to itself. For every station, the nearest point of the line at
/// least `least_length_m` before it is determined. The offset must be within its uncertainty: that of the
/// legs in between, which count as independent, and of the diver's position. No observation confirms that
/// these are the same places, so they must not be equated. Longest loop first.
std::vector<LoopCandidate> findLoopCandidates(const Survey& survey, const LoopOptions& options = {});

}  // namespace lodeline
