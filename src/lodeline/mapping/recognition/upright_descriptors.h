#pragma once

#include <optional>
#include <vector>

#include "lodeline/mapping/keyframe/descriptor.h"
#include "lodeline/mapping/recognition/keypoints/evened_image.h"

namespace lodeline {

/// Image point to be described.
struct PointToDescribe {
  Vec2 pixel = Vec2::Zero();  ///< in the image as recorded
  double sigma_px = 1.6;      ///< of the smoothing, in the evened image; the patch has the side 12 sigma
  /// Direction in the image, clockwise from the x axis, that the descriptor turns with, rad; empty for that
  /// of the intensity centroid.
  std::optional<double> up_rad;
};

/// Descriptors of image points: histograms of gradients (SIFT: D. Lowe, IJCV 2004) with two bits for each of
/// the 128 elements. The bits say whether the element exceeds the median of all, and the upper quartile (W.
/// Zhou, Y. Lu, H. Li and Q. Tian, "Scalar quantization for large scale image search", ACM Multimedia 2012).
/// Descriptors of unrelated points differ in about 112 bits. Empty for points whose patch is not in the
/// image.
std::vector<std::optional<Descriptor>> uprightDescriptors(const EvenedImage& image,
                                                          const std::vector<PointToDescribe>& points);

}  // namespace lodeline
