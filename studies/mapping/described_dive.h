#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "lodeline/cameras/camera.h"
#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// Keyframes of a simulated recording with their true poses.
struct DescribedDive {
  /// Runs the odometry over a recording of `lodeline simulate` with a cave seed. Throws InputError where the
  /// folder has no truth.
  explicit DescribedDive(const std::filesystem::path& folder);

  std::shared_ptr<const Camera> camera;  ///< camera 0, by the calibration files
  std::vector<MapKeyframe> keyframes;
  std::vector<Rigid3> cave_from_bodies;  ///< true pose of each keyframe, in axes of the cave
  int frames = 0;
  double path_m = 0.0;
  double describing_s = 0.0;  ///< processor time
};

}  // namespace lodeline
