#pragma once

#include "lodeline/estimator/factor_list.h"
#include "lodeline/estimator/options.h"
#include "lodeline/estimator/window.h"

namespace lodeline {

/// Whether the newest frame should become a keyframe: when it sees too few of what the last keyframe saw, has
/// moved far enough against it, or vision is short of landmarks. A rig that stands still makes no keyframes,
/// so that its window keeps what it knows.
bool wantsKeyframe(const Window& window, const FactorMaker& factors, const KeyframeOptions& options);

/// Median angle (rad) by which the tracks common to two frames have shifted in camera 0, rotation taken out;
/// nothing without common tracks.
std::optional<double> medianParallax(const Window& window, const Frame& a, const Frame& b,
                                     const FactorMaker& factors);

}  // namespace lodeline
