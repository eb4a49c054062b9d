#pragma once

#include <vector>

#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// Two moments of one dive whose surroundings may be the same: indices of keyframes, and the prediction.
struct CloudPair {
  size_t old_index = 0;
  size_t new_index = 0;
  Rigid3 old_from_new;                 ///< by odometry
  Mat6 covariance = Mat6::Identity();  ///< of its [dp, dtheta] in axes of the old body
  bool looks_back = false;             ///< the view differs by more than 90 degrees
};

struct InAndOutOptions {
  double spacing_m = 4.0;        ///< of pairs along the way back: a cloud's radius
  double least_path_m = 15.0;    ///< between both moments: less is the same stretch
  double most_distance_m = 1.5;  ///< beside the 3 sigma of the prediction: half the width of a passage
  int most_pairs = 200;
  Vec3 view_B = Vec3::UnitZ();  ///< optical axis of camera 0 in the body frame

  void check() const;
};

/// Pairs of stretches where the way back comes within 3 sigma of an earlier part of the way, one for each
/// `spacing_m` of path. Of the keyframes within reach, the pair takes the nearest. Pairs with the least
/// uncertainty come first: once registered, they narrow the others. Keyframes must be of one dive in their
/// order. Longer dives than `most_pairs` allows are spaced wider.
std::vector<CloudPair> inAndOutCandidates(const std::vector<MapKeyframe>& keyframes,
                                          const InAndOutOptions& options = {});

/// Covariance of [dp, dtheta] of a later body in the axes of an earlier one. The covariances are those of the
/// odometry relative to its start; drift between both adds up, so the difference of the covariances is that
/// of the relative pose. Errors of the earlier pose are part of the later one, moved by its lever.
Mat6 relativeCovariance(const MapKeyframe& earlier, const MapKeyframe& later);

}  // namespace lodeline
