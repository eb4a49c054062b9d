#include "lodeline/features/image_pyramid.h"

#include <algorithm>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "lodeline/base/wide_vectors.h"

namespace lodeline {
namespace {

/// `columns`: sums down the columns with one more at either end.
LODELINE_WIDE_VECTORS
void smoothRow(const uint8_t* __restrict above, const uint8_t* __restrict here,
               const uint8_t* __restrict below, int width, uint16_t* __restrict columns,
               float* __restrict smoothed) {
  for (int x = 0; x < width; ++x) columns[x + 1] = static_cast<uint16_t>(above[x] + 2 * here[x] + below[x]);
  columns[0] = columns[2];
  columns[width + 1] = columns[width - 1];
  for (int x = 0; x < width; ++x) {
    const auto sixteenths = static_cast<uint16_t>(columns[x] + 2 * columns[x + 1] + columns[x + 2]);
    smoothed[x] = static_cast<float>(sixteenths) / 16.0F;
  }
}

/// A Gaussian of the side given. The usual one, of three pixels, is made of whole numbers, at a fifth of the
/// price of OpenCV's sum of floating-point ones; the result is the same.
void smooth(const cv::Mat& image, int side_px, cv::Mat* smoothed) {
  if (side_px != 3 || image.rows < 2 || image.cols < 2) {
    // As cv::GaussianBlur, which cannot give floating-point pixels for those of 8 bits in one pass.
    const cv::Mat kernel = cv::getGaussianKernel(side_px, 0.0, CV_32F);
    cv::sepFilter2D(image, *smoothed, CV_32F, kernel, kernel);
    return;
  }
  smoothed->create(image.size(), CV_32F);
  std::vector<uint16_t> columns(static_cast<size_t>(image.cols) + 2);
  for (int y = 0; y < image.rows; ++y) {
    const int above = y > 0 ? y - 1 : 1, below = y + 1 < image.rows ? y + 1 : image.rows - 2;
    smoothRow(image.ptr(above), image.ptr(y), image.ptr(below), image.cols, columns.data(),
              smoothed->ptr<float>(y));
  }
}

}  // namespace

ImagePyramid::ImagePyramid(const cv::Mat& image, int levels, int smoothing_side_px) {
  constexpr int kSmallestSide = 16;
  levels_.reserve(static_cast<size_t>(levels));
  levels_.emplace_back();
  smooth(image, smoothing_side_px, &levels_.back());
  while (static_cast<int>(levels_.size()) < levels) {
    const cv::Mat& finer = levels_.back();
    if (std::min(finer.rows, finer.cols) < 2 * kSmallestSide) break;
    cv::Mat coarser;
    cv::pyrDown(finer, coarser);
    levels_.push_back(std::move(coarser));
  }
}

}  // namespace lodeline
