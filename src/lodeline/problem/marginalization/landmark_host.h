#pragma once

#include <optional>

#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Position of a track's landmark; empty for points too far away to have one (beyond 1 km).
std::optional<MapPoint> mapPointOf(const Window& window, TrackId id, const FeatureTrack& track,
                                   const FactorBuilder& factors);

/// Changes a landmark's host to the newest keyframe that observes it, other than `excluded`, without a change
/// of its position. Without such a keyframe, or when the point would lie behind it, the track loses its
/// landmark.
void moveToNewHost(const Window& window, FeatureTrack& track, FrameId excluded, const FactorBuilder& factors);

/// Splits a track after the frame `last`. Returns the observations up to that frame as a separate track,
/// whose landmark has the same position; the track keeps the later observations. Returns nothing and leaves
/// the track unchanged where either part would have too few observations or no host.
std::optional<FeatureTrack> splitTrack(const Window& window, FeatureTrack& track, FrameId last,
                                       const FactorBuilder& factors);

}  // namespace lodeline
