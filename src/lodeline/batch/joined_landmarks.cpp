#include "lodeline/batch/joined_landmarks.h"

#include <algorithm>
#include <optional>
#include <tuple>

#include "lodeline/batch/batch_structure.h"

namespace lodeline {
namespace {

/// Most states that observe one landmark: three passes of the longest track. The states of a landmark form a
/// clique, and a rig that stays in one place would connect thousands.
constexpr int kMostStates = 120;

class LandmarkJoiner {
 public:
  LandmarkJoiner(Window& window, const FactorBuilder& factors, const LandmarkOptions& options,
                 double loosening)
      : window_(window), factors_(factors), options_(options), loosening_(loosening) {}

  /// Returns whether both tracks are one landmark now.
  bool join(const LoopLink& link) {
    const TrackId a = rootOf(link.older), b = rootOf(link.newer);
    if (a == b) return true;
    const TrackId root = std::min(a, b), other = std::max(a, b);
    const std::vector<TrackId> first = partsOf(root), second = partsOf(other);
    std::vector<TrackId> parts = first;
    parts.insert(parts.end(), second.begin(), second.end());
    std::sort(parts.begin(), parts.end());
    const std::optional<FeatureTrack> joined = trackOf(parts);
    if (!joined || !agrees(*joined, first, second)) return false;
    for (const TrackId part : parts) root_of_[part] = root;
    parts_.erase(other);
    parts_[root] = std::move(parts);
    return true;
  }

  /// Puts the joined tracks into the window.
  JoinedLandmarks finish() {
    JoinedLandmarks joined;
    std::vector<FeatureTrack> tracks;
    for (const auto& [root, parts] : parts_) {
      joined.by_root[root] = joined.landmarks.size();
      joined.landmarks.push_back({parts});
      tracks.push_back(*trackOf(parts));
    }
    for (size_t i = 0; i < tracks.size(); ++i) {
      const std::vector<TrackId>& parts = joined.landmarks[i].parts;
      for (const TrackId part : parts) {
        if (loosening_ == 1.0) window_.tracks().at(part).observations.clear();
      }
      window_.tracks().at(parts.front()) = std::move(tracks[i]);
    }
    window_.removeEmptyTracks();
    return joined;
  }

 private:
  TrackId rootOf(TrackId piece) const {
    const auto known = root_of_.find(piece);
    return known == root_of_.end() ? piece : known->second;
  }
  std::vector<TrackId> partsOf(TrackId root) const {
    const auto known = parts_.find(root);
    return known == parts_.end() ? std::vector<TrackId>{root} : known->second;
  }

  /// All observations of some tracks; empty where two are seen in one image, or the states are too many.
  std::optional<FeatureTrack> trackOf(const std::vector<TrackId>& parts) const {
    FeatureTrack track;
    for (const TrackId part : parts) {
      for (Observation observation : window_.tracks().at(part).observations) {
        if (part != parts.front()) observation.measurement.sqrt_information /= loosening_;
        track.observations.push_back(observation);
      }
    }
    const auto key = [](const Observation& observation) {
      return std::tuple(observation.frame, observation.camera);
    };
    std::stable_sort(track.observations.begin(), track.observations.end(),
                     [&](const Observation& a, const Observation& b) { return key(a) < key(b); });
    const auto twice =
        std::adjacent_find(track.observations.begin(), track.observations.end(),
                           [&](const Observation& a, const Observation& b) { return key(a) == key(b); });
    if (twice != track.observations.end() || track.frameCount() > kMostStates) return std::nullopt;
    return track;
  }

  bool agrees(FeatureTrack joined, const std::vector<TrackId>& first,
              const std::vector<TrackId>& second) const {
    placeLandmark(window_, factors_, options_, &joined);
    if (!joined.landmark) return false;
    std::vector<ObservationError> errors;
    removeContradictions(window_, factors_, options_, 0, &joined, &errors);
    return joined.landmark && keepsHalf(joined, first) && keepsHalf(joined, second);
  }

  bool keepsHalf(const FeatureTrack& joined, const std::vector<TrackId>& parts) const {
    size_t kept = 0, all = 0;
    for (const TrackId part : parts) {
      for (const Observation& observation : window_.tracks().at(part).observations) {
        ++all;
        kept += joined.find(observation.frame, observation.camera) != nullptr;
      }
    }
    return 2 * kept >= all;
  }

  Window& window_;
  const FactorBuilder& factors_;
  const LandmarkOptions& options_;
  double loosening_;
  std::map<TrackId, TrackId> root_of_;
  std::map<TrackId, std::vector<TrackId>> parts_;  ///< of tracks with more than one, by the first
};

}  // namespace

JoinedLandmarks joinLandmarks(Window& window, const FactorBuilder& factors, const LandmarkOptions& options,
                              const std::vector<LoopLink>& links, double loosening) {
  LandmarkJoiner joiner(window, factors, options, loosening);
  int used = 0;
  for (const LoopLink& link : links) used += joiner.join(link) ? 1 : 0;
  JoinedLandmarks joined = joiner.finish();
  joined.links_used = used;
  return joined;
}

}  // namespace lodeline
