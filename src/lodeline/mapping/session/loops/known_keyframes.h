#pragma once

#include <map>
#include <optional>
#include <vector>

#include "lodeline/mapping/graph/motion/odometry_chain.h"
#include "lodeline/mapping/keyframe/map_keyframe.h"
#include "lodeline/mapping/recognition/loop_verifier.h"

namespace lodeline {

/// What is kept in memory of a keyframe; its features are in the map's file.
struct KnownKeyframe {
  KeyframeId id = -1;
  int dive = 0;
  Time time;
  Rigid3 odom_from_body;
  Rigid3 map_from_body;                ///< by the latest solution
  Vec3 view_B = Vec3::UnitX();         ///< mean viewing direction of its features, unit
  double path_m = 0.0;                 ///< along its dive, from the first keyframe
  std::optional<ScalarPrior> depth_m;  ///< below the surface
  std::optional<KeyframeField> field;
};

/// `path_m`: along the dive, from its first keyframe.
KnownKeyframe knownOf(const MapKeyframe& keyframe, const Rigid3& map_from_body, double path_m);

/// Uncertain position of one dive's odometry world in the map: rotation about the vertical, and translation.
struct DivePlacement {
  Rigid3 map_from_odom;
  Vec3 position_sigma_m = Vec3::Zero();  ///< of the first pose, along the axes of the map
  double azimuth_sigma_rad = 0.0;
  bool is_known = true;  ///< false: the sigmas mean nothing
};

/// The keyframes of a map, with the odometry of each dive and the accepted loops between them. It predicts
/// the relative pose of two keyframes.
class KnownKeyframes {
 public:
  /// Starts a dive. Its keyframes are placed by `placement` until loops place them.
  void startDive(int dive, const DivePlacement& placement);
  /// Adds the next keyframe of a started dive; `newest_from_this`: odometry from the one before, null for the
  /// first.
  void add(const KnownKeyframe& keyframe, const RelativePose* newest_from_this);
  /// Adds a loop that later predictions use.
  void addLoop(KeyframeId old_keyframe, KeyframeId new_keyframe, const RelativePose& old_from_new);

  const std::vector<KnownKeyframe>& all() const { return keyframes_; }
  std::vector<KnownKeyframe>& all() { return keyframes_; }
  const KnownKeyframe& at(KeyframeId id) const { return keyframes_[index_.at(id)]; }
  /// First keyframe of a dive.
  KeyframeId firstOf(int dive) const { return keyframes_[first_.at(dive)].id; }
  bool contains(KeyframeId id) const { return index_.count(id) > 0; }
  DivePlacement& placement(int dive) { return placements_.at(dive); }
  const DivePlacement& placement(int dive) const { return placements_.at(dive); }

  /// Pose of `to` in `from` by odometry within one dive; between dives by the solution.
  RelativePose between(KeyframeId from, KeyframeId to) const;

  /// Prediction of the pose of `to` in `from`: by the odometry between both, or by odometry to the ends of an
  /// accepted loop and that loop, whichever is more accurate. Between dives that no loop joins, it comes from
  /// their placements. Empty where these are not known.
  std::optional<LoopPrediction> predict(KeyframeId from, KeyframeId to) const;

 private:
  struct Link {
    KeyframeId old_keyframe, new_keyframe;
    RelativePose old_from_new;
  };
  RelativePose byPlacement(const KnownKeyframe& from, const KnownKeyframe& to) const;

  std::vector<KnownKeyframe> keyframes_;
  std::map<KeyframeId, size_t> index_;
  std::map<int, OdometryChain> chains_;
  std::map<int, DivePlacement> placements_;
  std::map<int, size_t> first_;  ///< keyframe of each dive, index into keyframes_
  std::vector<Link> loops_;
};

}  // namespace lodeline
