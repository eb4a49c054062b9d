#pragma once

#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Unit normals of points on walls: normal of the plane through each point's nearest neighbours (least
/// squares), on the side of the nearest of the `viewpoints` (not empty). With fewer than three neighbours, or
/// collinear ones, it is the direction to that viewpoint.
std::vector<Vec3> normalsTowards(const std::vector<Vec3>& points, const std::vector<Vec3>& viewpoints);

}  // namespace lodeline
