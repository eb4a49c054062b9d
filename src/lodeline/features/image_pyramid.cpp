#include "lodeline/features/image_pyramid.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace lodeline {

ImagePyramid::ImagePyramid(const cv::Mat& image, int levels, int smoothing_side_px) {
  constexpr int kSmallestSide = 16;
  levels_.reserve(static_cast<size_t>(levels));
  levels_.emplace_back();
  // As cv::GaussianBlur, which cannot give floating-point pixels for those of 8 bits in one pass.
  const cv::Mat kernel = cv::getGaussianKernel(smoothing_side_px, 0.0, CV_32F);
  cv::sepFilter2D(image, levels_.back(), CV_32F, kernel, kernel);
  while (static_cast<int>(levels_.size()) < levels) {
    const cv::Mat& finer = levels_.back();
    if (std::min(finer.rows, finer.cols) < 2 * kSmallestSide) break;
    cv::Mat coarser;
    cv::pyrDown(finer, coarser);
    levels_.push_back(std::move(coarser));
  }
}

}  // namespace lodeline
