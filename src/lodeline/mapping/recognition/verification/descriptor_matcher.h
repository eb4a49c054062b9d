#pragma once

#include <optional>
#include <vector>

#include "lodeline/mapping/keyframe/map_keyframe.h"
#include "lodeline/mapping/recognition/verification/loop_prediction.h"

namespace lodeline {

/// Features of two keyframes that resemble each other.
struct DescriptorMatch {
  FeatureMatch features;
  int distance = 0;  ///< bits that differ
  /// Largest angle, rad, between the predicted and the seen direction of the point; pi where the whole view
  /// was searched.
  double searched_rad = 0.0;
};

/// Pairs of features of which each is the other's nearest, and clearly nearer than the next one. With a
/// prediction that is narrow enough, only pairs within its reach compete. A track takes part in one match at
/// most. Matches are in the order of their distances.
std::vector<DescriptorMatch> matchDescriptors(const MapKeyframe& old_keyframe,
                                              const MapKeyframe& new_keyframe,
                                              const std::optional<LoopPrediction>& prediction);

}  // namespace lodeline
