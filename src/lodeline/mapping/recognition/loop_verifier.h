#pragma once

#include <optional>

#include "lodeline/mapping/keyframe/map_keyframe.h"
#include "lodeline/mapping/recognition/verification/loop_prediction.h"

namespace lodeline {

struct LoopVerifierOptions {
  /// Expected number of pairs of unrelated keyframes that chance would let pass, for each pair examined.
  double max_false_alarms = 1e-8;
  /// Smallest share of the view that the inliers cover.
  double min_covered_share = 0.15;
  /// Errors that all points of a keyframe share and that matches do not show: of distances (relative), and of
  /// the camera's rotation in the body. They come from the calibration, which may differ between dives.
  double common_distance_error = 0.003;
  double common_rotation_rad = 0.002;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

/// Decides whether two keyframes show the same place, and computes the pose of one in the other.
///
/// docs/theory/loop-verification.md derives the steps: mutual matches of descriptors, random samples of two
/// matches with known gravity, refinement of all six coordinates, and the decision. Loop::status is Verified
/// where all checks pass. Otherwise it is Matched or Candidate, with the reason in words. The same input
/// gives the same result.
class LoopVerifier {
 public:
  explicit LoopVerifier(const LoopVerifierOptions& options = {});

  /// Either keyframe may be one from mergeKeyframes(). Loop::source is left to the caller.
  Loop verify(const MapKeyframe& old_keyframe, const MapKeyframe& new_keyframe,
              const std::optional<LoopPrediction>& prediction = std::nullopt) const;

 private:
  LoopVerifierOptions options_;
};

}  // namespace lodeline
