#pragma once

#include <vector>

#include "simulation/rendering/cave/cave_walls.h"

namespace lodeline {

/// Answers whether points are within the walls of one passage. The walls of a ring are seen from its centre
/// in every direction, so a radius decides.
class TubeInterior {
 public:
  /// Keeps a reference to `walls`.
  explicit TubeInterior(const CaveWalls& walls);

  /// Whether a point is inside by at least `margin_m`; a negative margin also takes points outside, nearer
  /// than that to the walls.
  bool contains(const Vec3f& point, float margin_m) const;

 private:
  /// Ring whose plane is nearest to the point, or -1 beyond the ends.
  int ringAt(const Vec3f& point) const;

  const CaveWalls& walls_;
  float spacing_m_ = 0.0f;
  int coarse_step_ = 1;   ///< rings between two of the coarse search
  float reach_m_ = 0.0f;  ///< no wall is farther from its ring's centre
};

/// Removes the triangles of `mesh` whose corners are all inside the other tube by `margin_m`.
void removeInside(const TubeInterior& other, float margin_m, TriangleMesh* mesh);

}  // namespace lodeline
