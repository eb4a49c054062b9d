#include "lodeline/frontend/test_accuracy.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace lodeline {
namespace {

std::map<TrackId, Vec2> firstCamera(const FrameTracks& frame) {
  std::map<TrackId, Vec2> pixels;
  for (const FeatureObservation& observation : frame.observations) {
    if (observation.camera == 0) pixels[observation.track] = observation.pixel;
  }
  return pixels;
}

}  // namespace

TrackAccuracy accuracyOverTenFrames(const TestSequence& sequence, const std::vector<FrameTracks>& frames) {
  constexpr int kLater = 10;
  TrackAccuracy result;
  double squared = 0.0;
  const int starts = static_cast<int>(frames.size()) - kLater;
  for (int i = 0; i < starts; ++i) {
    const auto first = firstCamera(frames[static_cast<size_t>(i)]);
    const auto last = firstCamera(frames[static_cast<size_t>(i + kLater)]);
    for (const auto& [id, pixel] : first) {
      result.tracks += 1.0;
      const auto found = last.find(id);
      if (found == last.end()) continue;
      result.survived += 1.0;
      const Vec2 slip = found->second - *sequence.truePixel(i, 0, pixel, i + kLater, 0);
      result.bias_px += slip;
      squared += slip.squaredNorm();
    }
  }
  const double survivors = std::max(1.0, result.survived);
  result.bias_px /= survivors;
  result.rms_px = std::sqrt(squared / (2.0 * survivors));
  result.tracks /= starts;
  result.survived /= starts;
  return result;
}

}  // namespace lodeline
