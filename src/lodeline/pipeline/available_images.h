#pragma once

#include <filesystem>
#include <vector>

#include "lodeline/io/euroc/euroc_rig.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

/// The images of a recording in which a part may not have been rendered or copied yet.
struct AvailableImages {
  std::vector<Time> stamps;  ///< of the first camera's images up to the last moment that all cameras have
  double whole_s = 0.0;      ///< from its first listed image to the last one
  bool complete = true;      ///< false: images are missing at the end

  /// From the first to the last of `stamps`.
  double available_s() const;
};

/// Looks the listed images up from the end of each list; single images that are missing before that are the
/// estimator's affair. Throws InputError as findEurocLayout() does, and where a camera has no image at all.
AvailableImages findAvailableImages(const std::filesystem::path& data, const EurocOptions& options);

}  // namespace lodeline
