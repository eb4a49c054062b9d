#pragma once

#include <vector>

#include "lodeline/geometry/types.h"

namespace lodeline {

/// Unit normals of points on walls: of the plane through each point's nearest neighbours (least squares),
/// on the side on which the nearest point of `viewpoints` (not empty) lies. Where there are fewer than three
/// neighbours, or they lie on a line, the direction to that viewpoint.
std::vector<Vec3> normalsTowards(const std::vector<Vec3>& points, const std::vector<Vec3>& viewpoints);

}  // namespace lodeline
