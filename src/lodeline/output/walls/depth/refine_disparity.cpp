#include "lodeline/output/walls/depth/refine_disparity.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace lodeline {
namespace {

constexpr int kSide_px = 11, kRounds = 3;
constexpr float kLargestStep_px = 0.5F, kLargestChange_px = 1.0F;
constexpr float kFloor_px = 0.12F;
constexpr double kBlur_px = 1.2;
/// Pixels that share the noise of one, after the blur: the inverse of the sum of its squared weights.
constexpr auto kSharing = static_cast<float>(4.0 * std::numbers::pi * kBlur_px * kBlur_px);
constexpr float kNoise = 1.0F;  ///< variance of a grey value before the blur that residuals never fall below

cv::Mat windowMean(const cv::Mat& image) {
  cv::Mat mean;
  cv::boxFilter(image, mean, CV_32F, {kSide_px, kSide_px});
  return mean;
}

cv::Mat blurred(const cv::Mat& image) {
  cv::Mat grey;
  image.convertTo(grey, CV_32F);
  cv::GaussianBlur(grey, grey, {0, 0}, kBlur_px);
  return grey;
}

/// Covariances in windows of pixels where `known` is 1; its mean is `share`.
cv::Mat covariance(const cv::Mat& a, const cv::Mat& b, const cv::Mat& mean_a, const cv::Mat& mean_b,
                   const cv::Mat& known, const cv::Mat& share) {
  const cv::Mat products = windowMean(a.mul(b).mul(known)) / share;
  return products - mean_a.mul(mean_b);
}

/// Gives each pixel the mean of its window, but not where the window has an edge: a spread of a pixel or
/// more.
void smoothSurface(const cv::Mat& known, const cv::Mat& share, cv::Mat* value_px) {
  const cv::Mat mean = windowMean(value_px->mul(known)) / share;
  const cv::Mat variance = covariance(*value_px, *value_px, mean, mean, known, share);
  mean.copyTo(*value_px, (variance < 1.0F) & (known > 0.5F));
}

}  // namespace

Disparities refineDisparity(const cv::Mat& first, const cv::Mat& second, const cv::Mat& disparity_px) {
  const cv::Mat grey0 = blurred(first), grey1 = blurred(second);
  cv::Mat gradient1;
  cv::Sobel(grey1, gradient1, CV_32F, 1, 0, 1, 0.5);
  cv::Mat known;
  cv::Mat(disparity_px >= 0.0F).convertTo(known, CV_32F, 1.0 / 255.0);
  const cv::Mat share = windowMean(known) + 1e-6;
  cv::Mat columns(first.size(), CV_32F), rows(first.size(), CV_32F);
  for (int v = 0; v < first.rows; ++v) {
    for (int u = 0; u < first.cols; ++u) {
      columns.at<float>(v, u) = static_cast<float>(u);
      rows.at<float>(v, u) = static_cast<float>(v);
    }
  }
  Disparities result{disparity_px.clone(), cv::Mat(first.size(), CV_32F, cv::Scalar(-1.0))};
  cv::Mat variance_e, variance_g;
  for (int round = 0; round < kRounds; ++round) {
    smoothSurface(known, share, &result.value_px);
    const cv::Mat place = columns - result.value_px;
    cv::Mat seen, gradient;
    cv::remap(grey1, seen, place, rows, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    cv::remap(gradient1, gradient, place, rows, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    const cv::Mat error = grey0 - seen;
    const cv::Mat mean_e = windowMean(error.mul(known)) / share,
                  mean_g = windowMean(gradient.mul(known)) / share;
    variance_g = covariance(gradient, gradient, mean_g, mean_g, known, share);
    variance_e = covariance(error, error, mean_e, mean_e, known, share);
    const cv::Mat step = -covariance(gradient, error, mean_g, mean_e, known, share) / (variance_g + 1e-3);
    const cv::Mat limited = cv::min(cv::max(step, -kLargestStep_px), kLargestStep_px);
    result.value_px += limited.mul(known);
  }
  for (int v = 0; v < first.rows; ++v) {
    for (int u = 0; u < first.cols; ++u) {
      float& value = result.value_px.at<float>(v, u);
      const float start = disparity_px.at<float>(v, u);
      if (start < 0.0F || !(std::abs(value - start) <= kLargestChange_px)) {
        value = -1.0F;
        continue;
      }
      const float pixels = kSide_px * kSide_px * share.at<float>(v, u);
      const float by_noise = std::max(kNoise, kSharing * variance_e.at<float>(v, u)) /
                             (pixels * std::max(1e-3F, variance_g.at<float>(v, u)));
      result.sigma_px.at<float>(v, u) = std::sqrt(by_noise + kFloor_px * kFloor_px);
    }
  }
  return result;
}

}  // namespace lodeline
