#pragma once

#include <vector>

#include "lodeline/mapping/recognition/keypoints/evened_image.h"

namespace lodeline {

/// Blobs of an image: extrema of the difference of Gaussians over position and scale (D. Lowe, "Distinctive
/// image features from scale-invariant keypoints", IJCV 2004). They are found again from another distance and
/// under other light. Returns their pixels in the image as recorded, at most `most`, the strongest ones of
/// each part of the image. `visible`: 8-bit of the recorded image's size, zero where no blobs are wanted; may
/// be empty.
std::vector<Vec2> detectBlobs(const EvenedImage& image, const cv::Mat& visible, int most);

}  // namespace lodeline
