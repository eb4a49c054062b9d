#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace lodeline {

/// An image and its successive halvings, in floating point. A dim image whose texture spans only a few grey
/// levels would lose most of it by rounding if it were smoothed in 8 bits. Pixel (x, y) of level l is at (x,
/// y) * 2^l in the image.
class ImagePyramid {
 public:
  ImagePyramid() = default;
  /// `image`: 8-bit, one channel. Levels smaller than 16 px are omitted. `smoothing_side_px`: size (odd) of
  /// the Gaussian kernel that reduces noise before sampling.
  ImagePyramid(const cv::Mat& image, int levels, int smoothing_side_px = 3);

  bool empty() const { return levels_.empty(); }
  int levels() const { return static_cast<int>(levels_.size()); }
  /// CV_32FC1, grey levels.
  const cv::Mat& level(int index) const { return levels_[static_cast<size_t>(index)]; }

 private:
  std::vector<cv::Mat> levels_;
};

}  // namespace lodeline
