#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace lodeline {

/// Sums of gradient products over a window around every pixel of a cell: how much texture there is in which
/// direction.
class StructureTensor {
 public:
  static constexpr int kWindowRadius = 3;

  /// `image`: a level of an ImagePyramid. `cell` must lie at least `kWindowRadius + 1` pixels inside it.
  StructureTensor(const cv::Mat& image, const cv::Rect& cell);

  /// Root-mean-square gradient across the direction in which there is less of it, at a pixel of the cell;
  /// root of the smaller eigenvalue.
  float weakerGradientGreyPerPx(int column, int row) const {
    return weaker_[static_cast<size_t>(row) * static_cast<size_t>(width_) + static_cast<size_t>(column)];
  }

 private:
  int width_;
  std::vector<float> weaker_;
};

}  // namespace lodeline
