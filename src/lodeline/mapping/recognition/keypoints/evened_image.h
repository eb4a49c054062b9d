#pragma once

#include <opencv2/core/mat.hpp>

#include "lodeline/cameras/camera.h"
#include "lodeline/types.h"

namespace lodeline {

/// An image at a common angular resolution, with the same brightness and contrast everywhere. A lamp at the
/// rig lights the same rock differently at every visit; the pattern of the rock remains.
///
/// Each value is the difference from the Gaussian mean of the surroundings, divided by their standard
/// deviation and that of the sensor's noise: 128 + 40 (I - mean) / sqrt(variance + noise^2).
struct EvenedImage {
  cv::Mat grey;           ///< 8-bit
  double scale = 1.0;     ///< px of this image for each px of the recorded one, at most 1
  double focal_px = 1.0;  ///< px of this image for each radian, on the axis

  /// `image`: 8-bit grey, of `camera`.
  EvenedImage(const cv::Mat& image, const Camera& camera);

  /// Centres of pixels have whole numbers in both images.
  Vec2 fromRecorded(const Vec2& pixel) const { return scale * (pixel + Vec2(0.5, 0.5)) - Vec2(0.5, 0.5); }
  Vec2 toRecorded(const Vec2& pixel) const { return (pixel + Vec2(0.5, 0.5)) / scale - Vec2(0.5, 0.5); }
};

}  // namespace lodeline
