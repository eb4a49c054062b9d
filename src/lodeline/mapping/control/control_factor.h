#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/mapping/control/files/control_set.h"
#include "lodeline/mapping/store/map_change.h"

namespace lodeline {

/// One observation of a control point, for a pose graph: the point is at `in_body` in the body frame of a
/// keyframe. Where its position in the map is unknown, all factors of one name show the same point.
struct ControlFactor {
  std::string name;
  ControlKind kind = ControlKind::Station;
  KeyframeId keyframe = -1;
  PositionPrior in_body;
  std::optional<PositionPrior> in_map;
};

/// A keyframe as far as visits need it.
struct VisitedKeyframe {
  KeyframeId id = -1;
  Time time;
  Rigid3 odom_from_body;
};

struct VisitOptions {
  double reach_m = 0.3;  ///< one sigma of the distance between rig and mark while the diver holds it there
  double longest_gap_s = 5.0;  ///< between two keyframes around a visit
  /// One sigma of the odometry between a keyframe and the visit, over the way between them.
  double odometry_share = 0.05;

  /// Throws UsageError for values that are not positive.
  void check() const;
};

/// Factors of the visits of one dive. The position of the rig at the visit is interpolated between the two
/// keyframes around it, and belongs to the nearer one. `keyframes` in order of time. Throws InputError naming
/// the visit where no keyframes are around it.
std::vector<ControlFactor> factorsOfVisits(const ControlSet& control, const std::string& dive, Time start,
                                           std::span<const VisitedKeyframe> keyframes,
                                           const VisitOptions& options = {});

/// All observations of control points of a map.
std::vector<ControlFactor> controlFactorsOf(const MapFile& map);

/// Writes control points and factors to a map. Factors refer to the points by name.
void addControl(const ControlSet& control, std::span<const ControlFactor> factors, MapChange* change);

}  // namespace lodeline
