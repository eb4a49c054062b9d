#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "lodeline/mapping/keyframe/descriptor.h"
#include "lodeline/types.h"

namespace lodeline {

/// Image point to be described.
struct PointToDescribe {
  Vec2 pixel = Vec2::Zero();
  /// Direction in the image, clockwise from the x axis, that the descriptor turns with, rad; empty for that
  /// of the intensity centroid.
  std::optional<double> up_rad;
};

/// Descriptors of image points: the 256 comparisons of ORB in a patch of 31 x 31 px on the half-size image.
/// There, patches are as large as those of the front end, and noise is lower. Empty for points whose patch is
/// not in the image. `image`: 8-bit grey.
std::vector<std::optional<Descriptor>> uprightDescriptors(const cv::Mat& image,
                                                          const std::vector<PointToDescribe>& points);

}  // namespace lodeline
