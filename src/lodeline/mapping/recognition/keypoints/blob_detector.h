#pragma once

#include <vector>

#include "lodeline/mapping/recognition/keypoints/evened_image.h"

namespace lodeline {

/// A point of an image that is found again from elsewhere.
struct Keypoint {
  Vec2 pixel = Vec2::Zero();  ///< in the image as recorded
  double size_px = 0.0;       ///< diameter of the blob in the evened image
  double strength = 0.0;
};

/// Blobs: extrema of the difference of Gaussians over position and scale (D. Lowe, "Distinctive image
/// features from scale-invariant keypoints", IJCV 2004), the `most` strongest, spread over the image.
/// `visible`: 8-bit of the recorded image's size, zero where no points are wanted; may be empty.
std::vector<Keypoint> detectBlobs(const EvenedImage& image, const cv::Mat& visible, int most);

}  // namespace lodeline
