#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "lodeline/frontend/detection/image_pyramid.h"

namespace lodeline {

struct CornerDetectorOptions {
  int max_tracks = 250;
  double min_distance_px = 14.0;
  /// Root-mean-square gradient across the weaker direction of the texture, on the half-size image: twice that
  /// of a good sensor's noise.
  double min_gradient_grey_per_px = 0.5;
  /// The same limit in noisy images. It is relative to the mean absolute second difference, over steps of two
  /// pixels, in the smoothest tenth of the half-size image. Noise alone gives corners of up to 0.7. In clear
  /// images without a plain area that difference would be texture.
  double min_gradient_of_noise = 0.75;
  double border_px = 12.0;
};

/// Detects corners where there are no tracks. The image is divided into as many cells as points are wanted.
/// The strongest corner of each empty cell is used (smaller eigenvalue of the structure tensor, J. Shi and C.
/// Tomasi, "Good features to track", CVPR 1994). Corners are evaluated on the half-size image, where noise is
/// lower and the window is about as large as a patch. Particles (particle_filter.h) are skipped.
class CornerDetector {
 public:
  explicit CornerDetector(const CornerDetectorOptions& options) : options_(options) {}

  /// New corners, strongest first, px. `occupied`: positions of tracked points. `mask`: 8-bit of the image's
  /// size, zero where no points may be detected; may be empty. `noisy`: noise may be as strong as texture.
  std::vector<Eigen::Vector2f> detect(const ImagePyramid& image, const cv::Mat& mask,
                                      const std::vector<Eigen::Vector2f>& occupied, bool noisy = false) const;

 private:
  CornerDetectorOptions options_;
};

}  // namespace lodeline
