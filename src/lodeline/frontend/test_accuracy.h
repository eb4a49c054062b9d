#pragma once

#include <vector>

#include "lodeline/frontend/test_sequence.h"
#include "lodeline/frontend/tracking/tracks.h"

namespace lodeline {

/// Drift of the tracks of camera 0 relative to the truth over ten frames, averaged over all frames.
struct TrackAccuracy {
  double tracks = 0.0;    ///< in a frame
  double survived = 0.0;  ///< share of them ten frames later
  Vec2 bias_px = Vec2::Zero();
  double rms_px = 0.0;  ///< along each axis
};

/// `frames`: the sequence from its frame 0 on, more than ten of them.
TrackAccuracy accuracyOverTenFrames(const TestSequence& sequence, const std::vector<FrameTracks>& frames);

}  // namespace lodeline
