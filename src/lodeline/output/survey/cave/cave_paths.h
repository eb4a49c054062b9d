#pragma once

#include <optional>
#include <vector>

#include "lodeline/trajectory.h"

namespace lodeline {

struct CavePathOptions {
  /// A path this near to an earlier one, m, is a way through the same passage. 0 keeps every way.
  double merge_m = 2.5;
  double step_m = 0.5;    ///< between the points of a path
  double touch_m = 1.0;   ///< shorter contacts with an earlier path do not count
  double branch_m = 5.0;  ///< shorter ways off an earlier path are part of it

  /// A path this much longer than the way back to an earlier point has left it, m.
  double recent_m() const { return 3.0 * merge_m; }
};

/// A point of the path of a dive.
struct CavePathPoint {
  size_t dive = 0, pose = 0;  ///< indices
  Vec3 position = Vec3::Zero();
  double way_m = 0.0;  ///< along the path of the dive
  bool is_new = true;  ///< not a way through a passage that was swum before
};

/// Points first to last, one after the other on the path of one dive through a passage that no earlier path
/// goes through. Junctions are points of other branches, or of the same one.
struct CavePathBranch {
  size_t first = 0, last = 0;
  std::optional<size_t> begins_at, ends_at;
  bool is_connection =
      false;  ///< a line to a dive that meets no other; first is on one, ends_at on the other
};

struct CavePaths {
  std::vector<CavePathPoint> points;
  std::vector<CavePathBranch> branches;
  std::vector<size_t> apart;  ///< dives that meet no earlier one
};

/// Splits the paths of several dives in one frame into branches. Ways in and out, and ways of several dives
/// through one passage, become one branch: that of the first one. A dive that turns ends its branch at the
/// farthest point. Where a path comes back to an earlier one, its branch ends in a junction, which closes a
/// loop. Throws InputError where there is no path.
CavePaths splitPaths(const std::vector<std::vector<Vec3>>& positions, const CavePathOptions& options);

}  // namespace lodeline
