#pragma once

#include <optional>
#include <vector>

#include "lodeline/frontend/tracking/patch.h"
#include "lodeline/frontend/tracking/tracks.h"

namespace lodeline {

/// A tracked point of the front end. It is tracked in camera 0 and matched in the others.
struct Track {
  TrackId id = -1;
  int observations = 1;  ///< number of images of camera 0 that observe it
  /// Its patch at the first observation, or at the last renewal. Comparison with this patch, and not with
  /// that of the image before, prevents the accumulation of small alignment errors.
  PatchTemplate reference;
  PatchWarp warp;  ///< position of `reference` in the last image of camera 0
  /// Motion between the last two images that the rotation does not explain.
  Eigen::Vector2f parallax_px = Eigen::Vector2f::Zero();
  /// Distance from the predicted position in the last image; empty before the first prediction.
  std::optional<float> prediction_error_px;
  /// Its patch in the last image of camera 0, to be matched in the images taken at the same time.
  PatchTemplate current;
  /// 1/m along the ray of camera 0, from the last match in a secondary camera.
  std::optional<double> inverse_depth_per_m;
  /// Position in the last image of each secondary camera (index 0: camera 1).
  std::vector<std::optional<PatchWarp>> matches;
};

}  // namespace lodeline
