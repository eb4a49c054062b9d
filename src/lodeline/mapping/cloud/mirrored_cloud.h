#pragma once

#include <array>

#include "lodeline/mapping/cloud/local_cloud.h"

namespace lodeline {

/// Three counterparts of a cloud that no place has: mirrored left to right, mirrored front to back, and both.
/// The front is the horizontal direction in which the points spread most. They keep the size of the passage,
/// its height over its width, floor and roof, density and noise. What fits them as well proves nothing.
std::array<LocalCloud, 3> mirroredClouds(const LocalCloud& cloud);

}  // namespace lodeline
