#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "lodeline/frontend/detection/image_pyramid.h"

namespace lodeline {

struct CornerDetectorOptions {
  int max_tracks = 250;
  double min_distance_px = 14.0;
  /// Root-mean-square gradient across the weaker direction of the texture, on the half-size image: twice what
  /// the noise of a good sensor makes.
  double min_gradient_grey_per_px = 0.5;
  /// The same in noisy images: times the mean absolute second difference, over steps of two pixels, of the
  /// smoothest tenth of the half-size image. Noise alone makes corners of up to 0.7 of it. In clear images
  /// without a plain place that would be texture.
  double min_gradient_of_noise = 0.75;
  double border_px = 12.0;
};

/// Finds points worth following where there are none: the image is divided into as many cells as points are
/// wanted, and the strongest corner of each empty cell is taken (smaller eigenvalue of the structure tensor,
/// J. Shi and C. Tomasi, "Good features to track", CVPR 1994). Corners are rated on the half-size image,
/// where noise is lower and the window is about as large as a patch. Particles (particle.h) are passed over.
class CornerDetector {
 public:
  explicit CornerDetector(const CornerDetectorOptions& options) : options_(options) {}

  /// New corners, strongest first, px. `occupied`: where points are followed already. `mask`: 8-bit of the
  /// image's size, zero where nothing may be detected; may be empty. `noisy`: noise may be as strong as
  /// texture.
  std::vector<Eigen::Vector2f> detect(const ImagePyramid& image, const cv::Mat& mask,
                                      const std::vector<Eigen::Vector2f>& occupied, bool noisy = false) const;

 private:
  CornerDetectorOptions options_;
};

}  // namespace lodeline
