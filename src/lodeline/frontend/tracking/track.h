#pragma once

#include <optional>
#include <vector>

#include "lodeline/frontend/tracking/patch.h"
#include "lodeline/frontend/tracking/tracks.h"

namespace lodeline {

/// A point while the front end follows it. It lives in camera 0 and is matched into the others.
struct Track {
  TrackId id = -1;
  int observations = 1;  ///< images of camera 0 it was seen in
  /// Its looks when it was first seen, or when it last had to be renewed. Comparing with this and not with
  /// the image before keeps small errors of alignment from adding up.
  PatchTemplate reference;
  PatchWarp warp;  ///< where `reference` lies in the last image of camera 0
  /// How far it moved between the last two images beyond what the rotation explains.
  Eigen::Vector2f parallax_px = Eigen::Vector2f::Zero();
  /// How far it lay from where it was expected in the last image; nothing before there was such an image.
  std::optional<float> prediction_error_px;
  /// Its looks in the last image of camera 0, to be found in the images taken at the same time.
  PatchTemplate current;
  /// 1/m along the ray of camera 0, from the last match in another camera.
  std::optional<double> inverse_depth_per_m;
  /// Where it lies in the last image of each secondary camera (index 0: camera 1).
  std::vector<std::optional<PatchWarp>> matches;
};

}  // namespace lodeline
