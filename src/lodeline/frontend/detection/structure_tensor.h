#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace lodeline {

/// Structure tensor: sums of gradient products over a window around every pixel of a cell, i.e. the amount of
/// texture by direction.
class StructureTensor {
 public:
  static constexpr int kWindowRadius = 3;

  /// `image`: a level of an ImagePyramid. `cell` must lie at least `kWindowRadius + 1` pixels inside it.
  StructureTensor(const cv::Mat& image, const cv::Rect& cell);

  /// Root-mean-square gradient in the direction with the smaller one, at a pixel of the cell; root of the
  /// smaller eigenvalue.
  float weakerGradientGreyPerPx(int column, int row) const {
    return weaker_[static_cast<size_t>(row) * static_cast<size_t>(width_) + static_cast<size_t>(column)];
  }

 private:
  int width_;
  std::vector<float> weaker_;
};

}  // namespace lodeline
