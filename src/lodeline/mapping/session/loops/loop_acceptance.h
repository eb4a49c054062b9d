#pragma once

#include <map>
#include <vector>

#include "lodeline/mapping/graph/robust/pairwise_consistency.h"
#include "lodeline/mapping/session/loops/known_keyframes.h"

namespace lodeline {

/// A feature of an old keyframe that a new keyframe observes again.
struct LinkedFeature {
  TrackId old_track = -1;
  TrackId new_track = -1;
  std::vector<BodyRay> new_rays;
};

/// A verified loop with what the batch solution needs of it.
struct VerifiedLoop {
  Loop loop;
  std::vector<LinkedFeature> links;
};

/// What is known of the place of a loop beside its images.
struct LoopEvidence {
  bool has_prediction = false;  ///< a narrow prediction agreed with it
  bool needs_field = false;     ///< without one, the magnetic field could tell the place from others
};

/// Decides which verified loops are used. One loop alone is never used: others from other keyframes must
/// agree with it through the odometry between them (pairwise consistency). A place that merely looks alike
/// would have to look alike again after the rig has moved. Where the magnetic field can tell places apart and
/// no prediction does, the field must support most of those that agree.
class LoopAcceptance {
 public:
  /// Adds a verified loop. Without a prediction, more loops must agree. Returns the loops that are decided
  /// with it: accepted, or refused with the reason.
  std::vector<VerifiedLoop> add(VerifiedLoop verified, const LoopEvidence& evidence,
                                const KnownKeyframes& known);

  /// Refuses the loops that have waited for others in vain since before `newest`; all with `is_end`.
  std::vector<VerifiedLoop> expire(KeyframeId newest, const KnownKeyframes& known, bool is_end = false);

 private:
  struct Waiting {
    VerifiedLoop verified;
    LoopEvidence evidence;
  };
  std::vector<Waiting> waiting_;
  std::map<int, std::vector<Loop>> accepted_;  ///< by the dive of the old keyframe
};

}  // namespace lodeline
