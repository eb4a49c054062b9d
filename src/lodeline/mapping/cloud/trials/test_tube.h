#pragma once

#include <functional>
#include <random>
#include <vector>

#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline::test {

/// Passage with known walls, seen by a camera that swims through it. Its centre line bends in the horizontal
/// plane and rises; the distance of the wall from it depends on the position along and around.
struct Tube {
  double length_m = 60.0;
  double radius_m = 1.2;
  double bend_rad = 0.5;  ///< amplitude of the heading of the centre line
  double bump_m = 0.25;   ///< height of the largest bumps
  double bumps_per_m = 3.0;
  bool is_extruded = false;    ///< bumps are ridges along the passage: the same profile everywhere
  bool has_two_walls = false;  ///< two vertical planes, no floor and no ceiling
  unsigned seed = 1;
};

class TubeWorld {
 public:
  explicit TubeWorld(const Tube& tube);

  Vec3 centre(double along_m) const;
  double heading(double along_m) const;
  /// Pose of a body (z forward, x right, y down) on the centre line, looking along it or back.
  Rigid3 body(double along_m, bool looks_back) const;
  /// Distance to the wall along a ray, or a negative number beyond 8 m.
  double rangeAlong(const Vec3& origin, const Vec3& direction, double along_m) const;

 private:
  struct Bump {
    double along_m, around_rad, height_m, width_along_m, width_around_rad;
  };
  double radiusAt(double along_m, double around_rad) const;
  /// Distance outside of the wall (negative inside); `along_m` is the place on the centre line, updated.
  double outside(const Vec3& place, double& along_m) const;

  Tube tube_;
  std::vector<Bump> bumps_;
  std::vector<Vec3> centres_;
  std::vector<double> headings_;
};

struct TubeNoise {
  double points_per_m = 60.0;
  double sigma_per_m = 0.005;   ///< along the ray: this times the distance squared
  double scale = 1.0;           ///< of all distances
  double outlier_share = 0.0;   ///< distances that are random
  double particle_share = 0.0;  ///< points that float in the passage
};

/// Keyframes every 0.5 m on the way from `from_m` to `to_m` (back, where that is less), with features at
/// `points_per_m`. Poses are `moved(true pose, path)`, the features are those of the true poses.
std::vector<MapKeyframe> swim(const TubeWorld& world, double from_m, double to_m, const TubeNoise& noise,
                              std::mt19937_64& random,
                              const std::function<Rigid3(const Rigid3&, double)>& moved = nullptr);

}  // namespace lodeline::test
