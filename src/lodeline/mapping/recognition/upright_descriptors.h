#pragma once

#include <optional>
#include <vector>

#include "lodeline/mapping/keyframe/descriptor.h"
#include "lodeline/mapping/recognition/keypoints/evened_image.h"

namespace lodeline {

/// Image point to be described.
struct PointToDescribe {
  Vec2 pixel = Vec2::Zero();  ///< in the image as recorded
  double size_px = 0.0;       ///< diameter of what is described, in the evened image
  /// Direction in the image, clockwise from the x axis, that the descriptor turns with, rad; 0 where empty.
  std::optional<double> up_rad;
};

/// Descriptors of image points. Empty for points whose patch is not in the image.
std::vector<std::optional<Descriptor>> uprightDescriptors(const EvenedImage& image,
                                                          const std::vector<PointToDescribe>& points);

}  // namespace lodeline
