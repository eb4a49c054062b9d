#include "lodeline/frontend/detection/image_quality.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lodeline {
namespace {

/// Mean absolute second difference along rows and columns, grey levels: insensitive to brightness gradients.
double detailGrey(const cv::Mat& image) {
  double sum = 0.0;
  int64_t count = 0;
  for (int y = 1; y + 1 < image.rows; y += 2) {
    const auto* above = image.ptr<float>(y - 1);
    const auto* here = image.ptr<float>(y);
    const auto* below = image.ptr<float>(y + 1);
    for (int x = 1; x + 1 < image.cols; x += 2) {
      sum += static_cast<double>(std::abs(here[x - 1] - 2.0F * here[x] + here[x + 1]) +
                                 std::abs(above[x] - 2.0F * here[x] + below[x]));
      count += 2;
    }
  }
  return sum / static_cast<double>(std::max<int64_t>(1, count));
}

}  // namespace

ImageQuality assess(const ImagePyramid& image) {
  constexpr double kDarkGrey = 12.0, kSaturatedShare = 0.3, kTexturelessGrey = 0.35, kFaintGrey = 1.5,
                   kBlurredShare = 0.265;
  constexpr int kSaturatedGrey = 250;
  ImageQuality quality;
  if (image.empty()) return quality;

  const cv::Mat& small = image.level(std::min(2, image.levels() - 1));
  double sum = 0.0, sum_of_squares = 0.0;
  int64_t saturated = 0;
  for (int y = 0; y < small.rows; ++y) {
    const auto* row = small.ptr<float>(y);
    for (int x = 0; x < small.cols; ++x) {
      const double grey = row[x];
      sum += grey;
      sum_of_squares += grey * grey;
      saturated += grey >= kSaturatedGrey ? 1 : 0;
    }
  }
  const auto count = static_cast<double>(small.total());
  quality.mean_grey = sum / count;
  quality.contrast_grey =
      std::sqrt(std::max(0.0, sum_of_squares / count - quality.mean_grey * quality.mean_grey));
  quality.saturated = static_cast<double>(saturated) / count;
  const double fine = detailGrey(image.level(std::min(1, image.levels() - 1)));
  quality.texture_grey = detailGrey(small);
  quality.sharpness = fine / std::max(1e-9, fine + quality.texture_grey);

  if (quality.mean_grey < kDarkGrey) {
    quality.word = "dark";
  } else if (quality.saturated > kSaturatedShare) {
    quality.word = "overexposed";
  } else if (quality.texture_grey < kTexturelessGrey) {
    quality.word = "textureless";
  } else if (quality.texture_grey < kFaintGrey) {
    quality.word = "faint";
  } else if (quality.sharpness < kBlurredShare) {
    quality.word = "blurred";
  }
  return quality;
}

}  // namespace lodeline
