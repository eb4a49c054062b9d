#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/mapping/recognition/descriptor_index.h"
#include "lodeline/mapping/recognition/loop_verifier.h"
#include "lodeline/mapping/store/map_file.h"

namespace lodeline {

/// Where a clip was found in a map.
struct PlaceInMap {
  Rigid3 map_from_body;            ///< at the last keyframe of the clip
  Mat6 covariance = Mat6::Zero();  ///< of [dp, dtheta] in map axes
  std::vector<Loop> loops;         ///< with the keyframes of the map that agree
};

/// Finds the place of short clips in a map by appearance alone, without any knowledge of where they are.
class Relocalizer {
 public:
  /// Reads the map's keyframes; the map must outlive this object.
  explicit Relocalizer(const MapFile& map, const LoopVerifierOptions& options = {});

  /// `clip`: consecutive keyframes of one to three seconds. At least two keyframes of the map must agree on
  /// the pose, because one alone may look alike by chance. Nothing where the place is not found; `reason`
  /// receives why.
  std::optional<PlaceInMap> find(std::span<const MapKeyframe> clip, std::string* reason) const;

 private:
  /// A place of the clip's last keyframe by one keyframe of the map.
  struct Found {
    Rigid3 map_from_body;
    Mat6 covariance;
    Loop loop;
  };
  /// Places by the keyframes of the map that look like `keyframe`. `seen_from_last`: pose of the clip's last
  /// body in that of `keyframe`. `reason` receives why candidates were refused.
  std::vector<Found> examine(const MapKeyframe& keyframe, const Rigid3& seen_from_last,
                             std::string* reason) const;

  const MapFile& map_;
  LoopVerifier verifier_;
  DescriptorIndex index_;
};

}  // namespace lodeline
