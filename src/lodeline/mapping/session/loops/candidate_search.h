#pragma once

#include <vector>

#include "lodeline/mapping/recognition/descriptor_index.h"
#include "lodeline/mapping/session/loops/known_keyframes.h"

namespace lodeline {

struct CandidateSearchOptions {
  /// Keyframes of the same dive are candidates only where the path between them is at least this long.
  double least_path_m = 8.0;
  /// Distance from which the same scene is still recognized.
  double view_distance_m = 1.5;
  /// Angle between the viewing directions up to which the views overlap, 40 degrees.
  double view_angle_rad = 0.7;
  int most_candidates = 3;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

/// A keyframe that may show the same place as the newest one.
struct LoopCandidateKeyframe {
  KeyframeId id = -1;
  std::optional<LoopPrediction> prediction;  ///< of the newest body in its body
  bool is_wide = false;                      ///< whether the prediction leaves the choice to appearance
  const char* source() const { return prediction && !is_wide ? "geometry" : "appearance"; }
};

/// Chooses the keyframes that may show the same place as the newest one. The prediction must allow it within
/// three sigma: position, depth, and heading within the overlap of the views. Among those, the descriptors
/// decide which ones are examined. Where the prediction is wide, this is recognition by appearance alone.
class CandidateSearch {
 public:
  explicit CandidateSearch(const CandidateSearchOptions& options);

  /// `newest` is known, and not in the index.
  std::vector<LoopCandidateKeyframe> find(const MapKeyframe& newest, const KnownKeyframes& known,
                                          const DescriptorIndex& index) const;

 private:
  bool isPossible(const KnownKeyframe& old_keyframe, const KnownKeyframe& newest,
                  const LoopPrediction& prediction) const;

  CandidateSearchOptions options_;
};

}  // namespace lodeline
