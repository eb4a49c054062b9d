#pragma once

#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Whether the newest frame should become a keyframe. It should if it observes too few of the last keyframe's
/// landmarks, has moved far enough, or sees too few landmarks. A rig at rest makes no keyframes, so that its
/// window keeps its information.
bool wantsKeyframe(const Window& window, const FactorBuilder& factors, const KeyframeOptions& options);

/// Makes the last frame with at least `least_landmarks` landmarks a keyframe when it is about to leave the
/// `recent_frames`, where images have ended. Otherwise the observations of that frame would be dropped
/// together with all image information on the motion since the last keyframe. For a rig that has been at
/// rest, that is all image information.
void keepLastView(Window& window, int recent_frames, int least_landmarks);

/// The keyframes before and after a frame that leaves the window's recent frames and should be interpolated
/// between them. It should if it observes landmarks and is far enough in time from other frames for
/// independent information (close frames have similar errors). Empty where the next keyframe does not exist
/// yet, or is too far away for the motion in between to be known.
struct KeyframesAbout {
  const Frame* before;
  const Frame* after;
};
std::optional<KeyframesAbout> keyframesAbout(const Window& window, const Frame& frame,
                                             const WindowOptions& options);

/// Median angle (rad) of the shift of two frames' common tracks in camera 0, after compensation of the
/// rotation; empty without common tracks.
std::optional<double> medianParallax(const Window& window, const Frame& a, const Frame& b,
                                     const FactorBuilder& factors);

}  // namespace lodeline
