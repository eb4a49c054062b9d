#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/mapping/session/loops/known_keyframes.h"

namespace lodeline {

/// A tag seen at a keyframe, with the position of its centre in the body frame of that keyframe.
struct TagSeenAt {
  KeyframeId keyframe = -1;
  Vec3 centre_B = Vec3::Zero();        ///< m
  Mat3 covariance = Mat3::Identity();  ///< m^2, body axes
};

/// A place at which a tag hangs. All its observations show the same point.
struct TagPlace {
  int tag = 0;
  std::string name;  ///< of its control point
  std::vector<TagSeenAt> observations;
};

/// How far two observations are from showing the same point, by the predicted pose of one keyframe in the
/// other.
struct TagAgreement {
  double distance_m = 0.0;
  double chi_squared = 0.0;  ///< 3 degrees of freedom
  bool holds() const;
};

/// The observations show the points q_a and q_b in two bodies. With the pose (R, p) of the second body in the
/// first, the difference is q_a - (R q_b + p). Its covariance is Q_a + R Q_b R^T + J P J^T with
/// J = [I, -[R q_b]x] and the covariance P of the pose.
TagAgreement agreementOf(const TagSeenAt& old_seen, const TagSeenAt& new_seen,
                         const LoopPrediction& old_from_new);

/// A place of the present dive that may be the same as a place of an earlier one, by its number alone.
struct HeldTag {
  size_t own_place = 0, earlier_place = 0;
};

/// Whether the horizontal distance and the difference in height of two tags are the same in two dives, with
/// 99.9 % of true pairs. Says no where the tags are so close that this means nothing.
bool haveSameSpacing(const TagPlace& own_1, const TagPlace& own_2, const TagPlace& earlier_1,
                     const TagPlace& earlier_2, const KnownKeyframes& known);

}  // namespace lodeline
