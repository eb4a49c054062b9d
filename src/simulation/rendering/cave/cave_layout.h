#pragma once

#include <vector>

#include "simulation/rendering/cave/centerline.h"

namespace lodeline {

/// The passages of a cave. Where two of them overlap, they are one space.
struct CaveLayout {
  std::vector<Centerline> passages;

  CaveLayout translated(const Vec3& offset_W) const;
};

/// Whether a point is inside the elliptical section of a passage, reduced to `share` of its size.
bool insidePassage(const Centerline& passage, const Vec3& point_W, double share);

}  // namespace lodeline
