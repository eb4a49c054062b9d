#pragma once

#include <optional>

#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// Where a track's landmark is now; nothing for points too far away to have a position (beyond 1 km).
std::optional<MapPoint> mapPointOf(const Window& window, TrackId id, const FeatureTrack& track,
                                   const FactorBuilder& factors);

/// Moves a landmark to the newest keyframe that sees it, other than `excluded`, keeping its position. Without
/// such a keyframe, or when the point would lie behind it, the track loses its landmark.
void moveToNewHost(const Window& window, FeatureTrack& track, FrameId excluded, const FactorBuilder& factors);

/// Cuts a track behind the frame `last`: returns what was seen up to there as a track of its own, whose
/// landmark is at the same point, and leaves the later observations to the track. Nothing, and the track as
/// it was, where either part would have too few observations or no host.
std::optional<FeatureTrack> splitTrack(const Window& window, FeatureTrack& track, FrameId last,
                                       const FactorBuilder& factors);

}  // namespace lodeline
