#pragma once

#include <span>

#include "lodeline/rig.h"

namespace lodeline {

/// Throws InputError, naming the time, unless there are at least `fewest` readings, all finite, with strictly
/// increasing times.
void requireUsable(std::span<const ImuSample> samples, size_t fewest = 2);

}  // namespace lodeline
