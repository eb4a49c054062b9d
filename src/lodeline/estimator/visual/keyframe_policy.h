#pragma once

#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// Whether the newest frame should become a keyframe: when it sees too few of what the last keyframe saw, has
/// moved far enough against it, or vision is short of landmarks. A rig that stands still makes no keyframes,
/// so that its window keeps what it knows.
bool wantsKeyframe(const Window& window, const FactorBuilder& factors, const KeyframeOptions& options);

/// Where images have ended: the last frame that saw at least so many landmarks becomes a keyframe when it is
/// about to leave the `recent_frames`. Any other frame's observations would be dropped with it, and with them
/// all that images said of the motion since the last keyframe: of a rig that has rested so far, everything.
void keepLastView(Window& window, int recent_frames, int least_landmarks);

/// The keyframes before and after a frame that is neither and leaves the window's recent ones, where it is
/// worth being interpolated between them: when it saw landmarks, and far enough from other frames in time for
/// what it saw to tell something that they do not (their errors are alike otherwise). Nothing where the next
/// keyframe has not come yet, or is too far away for the way there to be known.
struct KeyframesAbout {
  const Frame* before;
  const Frame* after;
};
std::optional<KeyframesAbout> keyframesAbout(const Window& window, const Frame& frame,
                                             const WindowOptions& options);

/// Median angle (rad) by which the tracks common to two frames have shifted in camera 0, rotation taken out;
/// nothing without common tracks.
std::optional<double> medianParallax(const Window& window, const Frame& a, const Frame& b,
                                     const FactorBuilder& factors);

}  // namespace lodeline
