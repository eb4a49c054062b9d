#pragma once

#include <cstddef>
#include <vector>

#include "lodeline/evaluation/trajectory/trajectory.h"

namespace lodeline {

/// Share of the expected poses that were estimated.
struct Completion {
  double share = 0.0;         ///< 0 to 1
  bool by_images = false;     ///< share of images with a pose; otherwise share of the reference's time
  std::size_t expected = 0;   ///< images
  std::size_t estimated = 0;  ///< images
};

/// Share of the images that have an estimated pose within `tolerance` of their time.
Completion completionByImages(const Trajectory& estimate, const std::vector<Time>& image_stamps,
                              Duration time_offset, Duration tolerance);

/// Share of the reference's time span that the estimate covers. A gap between two poses counts as covered if
/// it is shorter than a second or three times the estimate's usual interval. The spacing of a keyframe
/// trajectory is then not a gap. 0 for a reference of zero duration.
Completion completionByTime(const Trajectory& estimate, const Trajectory& reference, Duration time_offset);

}  // namespace lodeline
