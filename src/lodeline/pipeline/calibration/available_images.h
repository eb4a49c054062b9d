#pragma once

#include <filesystem>
#include <vector>

#include "lodeline/io/euroc/euroc_rig.h"
#include "lodeline/types.h"

namespace lodeline {

/// Available images of a recording, the last part of which may not be rendered or copied yet.
struct AvailableImages {
  std::vector<Time>
      stamps;  ///< of the first camera's images up to the last time for which all cameras have images
  double whole_s = 0.0;  ///< from its first listed image to the last one
  bool complete = true;  ///< false: images are missing at the end

  /// From the first to the last of `stamps`.
  double available_s() const;
};

/// Searches the listed images from the end of each list; the estimator handles single missing images before
/// that. Throws InputError as findEurocLayout() does, and where a camera has no image at all.
AvailableImages findAvailableImages(const std::filesystem::path& data, const EurocOptions& options);

}  // namespace lodeline
