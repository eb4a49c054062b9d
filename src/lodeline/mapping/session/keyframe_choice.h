#pragma once

#include <optional>

#include "lodeline/estimate.h"

namespace lodeline {

/// When a frame becomes a keyframe of the map.
struct KeyframeChoiceOptions {
  double distance_m = 0.4;         ///< moved since the last one
  double turn_rad = 0.26;          ///< turned since the last one, 15 degrees
  double least_interval_s = 0.25;  ///< between two of them
  /// Time after which a smaller motion is enough: a hand-held rig may stay within a metre.
  double usual_interval_s = 1.5;
  double least_distance_m = 0.1;
  double least_turn_rad = 0.07;  ///< 4 degrees

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

/// Chooses the frames of a run that become keyframes of the map: the first frame with a pose, and each frame
/// that has moved or turned far enough since the last one; less is enough some time after it. Frames without
/// usable images are left out.
class KeyframeChoice {
 public:
  explicit KeyframeChoice(const KeyframeChoiceOptions& options);

  /// Whether a frame is one; frames in order of time.
  bool add(const FrameEstimate& estimate);

 private:
  KeyframeChoiceOptions options_;
  std::optional<NavigationState> last_;
};

}  // namespace lodeline
