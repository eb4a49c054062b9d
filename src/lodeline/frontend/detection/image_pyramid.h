#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace lodeline {

/// An image and its successive halvings, in floating point: a dim picture whose texture spans only a few grey
/// levels would lose most of it to rounding when it is smoothed in 8 bits. Pixel (x, y) of level l is
/// (x, y) * 2^l of the image.
class ImagePyramid {
 public:
  ImagePyramid() = default;
  /// `image`: 8-bit, one channel. Levels that would be smaller than 16 px are left out. `smoothing_side_px`:
  /// of the Gaussian kernel (odd) that keeps noise from being sampled along with the texture.
  ImagePyramid(const cv::Mat& image, int levels, int smoothing_side_px = 3);

  bool empty() const { return levels_.empty(); }
  int levels() const { return static_cast<int>(levels_.size()); }
  /// CV_32FC1, grey levels.
  const cv::Mat& level(int index) const { return levels_[static_cast<size_t>(index)]; }

 private:
  std::vector<cv::Mat> levels_;
};

}  // namespace lodeline
