#pragma once

#include <random>
#include <vector>

#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// A point of a synthetic scene with its look.
struct ScenePoint {
  Vec3 position_W = Vec3::Zero();
  Descriptor look;
};

/// What a synthetic keyframe differs in from a perfect one.
struct SceneErrors {
  double sigma_rad = 0.002;       ///< of rays
  double tilt_sigma_rad = 0.001;  ///< of the odometry's roll and pitch
  int flipped_bits = 16;          ///< of each descriptor
  double scale = 1.0;             ///< of all distances
  double share_with_point = 1.0;
};

/// Makes points, and keyframes of a stereo rig that observes them. The body's x axis points ahead, its z axis
/// up. The same seed gives the same scenes.
class SceneMaker {
 public:
  explicit SceneMaker(uint64_t seed) : random_(seed) {}

  double uniform(double least, double most) {
    return least + (most - least) * static_cast<double>(random_() >> 11) * 0x1.0p-53;
  }
  double normal();
  size_t below(size_t count) { return random_() % count; }
  Vec3 normal3(double sigma) { return sigma * Vec3(normal(), normal(), normal()); }
  Descriptor look();
  /// Points 2 to 6 m ahead of a body at the origin, in a view of 80 by 60 degrees.
  std::vector<ScenePoint> points(int count);
  /// Pose near the origin: within `reach_m` and `turn_rad`.
  Rigid3 pose(double reach_m, double turn_rad);
  /// The keyframe of a body at a pose. Its odometry has another origin and heading.
  MapKeyframe keyframe(const std::vector<ScenePoint>& points, const Rigid3& world_from_body,
                       const SceneErrors& errors = {});

 private:
  std::mt19937_64 random_;
  KeyframeId next_id_ = 0;
};

}  // namespace lodeline
