#include "lodeline/frontend/detection/image_pyramid.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "lodeline/util/simd_dispatch.h"

namespace lodeline {
namespace {

// Integer weights of cv::getGaussianKernel(side, 0), from the middle outwards.
constexpr std::array<int, 2> kThree = {2, 1};
constexpr std::array<int, 4> kSeven = {18, 14, 7, 2};

/// Computes one row of the smoothed image from its neighbouring rows, with this row in the middle. `columns`:
/// buffer for the sums along the columns, enlarged by the kernel's radius at both ends, where the image is
/// mirrored at its outermost pixels.
template <size_t kWeights>
inline __attribute__((always_inline)) void smoothRowBy(const std::array<int, kWeights>& weights,
                                                       const uint8_t* const* rows, int width,
                                                       uint16_t* __restrict columns,
                                                       float* __restrict smoothed) {
  constexpr int kReach = kWeights - 1;
  int total = weights[0];
  for (int k = 1; k <= kReach; ++k) total += 2 * weights[static_cast<size_t>(k)];
  const float scale = 1.0F / static_cast<float>(total * total);
  for (int x = 0; x < width; ++x) {
    auto sum = static_cast<uint16_t>(weights[0] * rows[kReach][x]);
    for (int k = 1; k <= kReach; ++k) {
      const auto pair = static_cast<uint16_t>(rows[kReach - k][x] + rows[kReach + k][x]);
      sum = static_cast<uint16_t>(sum + weights[static_cast<size_t>(k)] * pair);
    }
    columns[kReach + x] = sum;
  }
  for (int k = 1; k <= kReach; ++k) {
    columns[kReach - k] = columns[kReach + k];
    columns[kReach + width - 1 + k] = columns[kReach + width - 1 - k];
  }
  for (int x = 0; x < width; ++x) {
    const uint16_t* middle = columns + kReach + x;
    int sum = weights[0] * middle[0];
    for (int k = 1; k <= kReach; ++k) sum += weights[static_cast<size_t>(k)] * (middle[-k] + middle[k]);
    smoothed[x] = scale * static_cast<float>(sum);
  }
}

LODELINE_WIDE_VECTORS
void smoothRow(const std::array<int, 2>&, const uint8_t* const* rows, int width, uint16_t* columns,
               float* smoothed) {
  smoothRowBy(kThree, rows, width, columns, smoothed);
}

LODELINE_WIDE_VECTORS
void smoothRow(const std::array<int, 4>&, const uint8_t* const* rows, int width, uint16_t* columns,
               float* smoothed) {
  smoothRowBy(kSeven, rows, width, columns, smoothed);
}

template <size_t kWeights>
void smooth(const cv::Mat& image, const std::array<int, kWeights>& weights, cv::Mat* smoothed) {
  constexpr int kReach = kWeights - 1, kSide = 2 * kReach + 1;
  smoothed->create(image.size(), CV_32F);
  std::vector<uint16_t> columns(static_cast<size_t>(image.cols + 2 * kReach));
  std::array<const uint8_t*, kSide> rows{};
  for (int y = 0; y < image.rows; ++y) {
    for (int k = -kReach; k <= kReach; ++k) {
      const int mirrored = std::min(std::abs(y + k), 2 * (image.rows - 1) - (y + k));
      rows[static_cast<size_t>(k + kReach)] = image.ptr(mirrored);
    }
    smoothRow(weights, rows.data(), image.cols, columns.data(), smoothed->ptr<float>(y));
  }
}

/// Gaussian smoothing as in cv::GaussianBlur, which cannot convert 8-bit pixels to floating point. The result
/// is bit-identical to OpenCV's filter with floating-point weights, which takes half as long again.
void smooth(const cv::Mat& image, int side_px, cv::Mat* smoothed) {
  const bool is_wide = std::min(image.rows, image.cols) > side_px / 2;
  if (side_px == 3 && is_wide) {
    smooth(image, kThree, smoothed);
  } else if (side_px == 7 && is_wide) {
    smooth(image, kSeven, smoothed);
  } else {
    const cv::Mat kernel = cv::getGaussianKernel(side_px, 0.0, CV_32F);
    cv::sepFilter2D(image, *smoothed, CV_32F, kernel, kernel);
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
