#include "lodeline/output/walls/depth/stereo_depth.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "lodeline/output/walls/depth/refine_disparity.h"

namespace lodeline {

cv::Mat textureOf(const cv::Mat& grey) {
  constexpr int kWindow_px = 11;
  cv::Mat along_x, along_y;
  cv::Sobel(grey, along_x, CV_32F, 1, 0, 1, 0.5);
  cv::Sobel(grey, along_y, CV_32F, 0, 1, 1, 0.5);
  cv::Mat energy = along_x.mul(along_x) + along_y.mul(along_y), mean, texture;
  cv::boxFilter(energy, mean, CV_32F, {kWindow_px, kWindow_px});
  cv::sqrt(mean, texture);
  return texture;
}

namespace {

/// A matcher keeps buffers, so each thread needs one.
cv::Ptr<cv::StereoSGBM> makeMatcher(const RectifiedView& view, const DepthImageOptions& options) {
  constexpr int kBlock_px = 5, kSmall = 8 * kBlock_px * kBlock_px, kLarge = 4 * kSmall;
  constexpr int kSpeck_px = 150, kStep = 2, kUnique_percent = 8, kBack_px = 1, kContrast = 31;
  const PinholeView& pinhole = view.pinhole();
  const double largest_px = pinhole.focal_px * view.baseline_m() / options.nearest_m;
  const int wanted = 16 * std::max(1, static_cast<int>(std::ceil(largest_px / 16.0)));
  const int disparities = std::min(wanted, std::max(16, pinhole.width_px / 32 * 16));
  return cv::StereoSGBM::create(0, disparities, kBlock_px, kSmall, kLarge, kBack_px, kContrast,
                                kUnique_percent, kSpeck_px, kStep, cv::StereoSGBM::MODE_SGBM_3WAY);
}

}  // namespace

StereoDepth::StereoDepth(const RectifiedView& view, const DepthImageOptions& options)
    : view_(view), options_(options) {}

DepthImage StereoDepth::compute(const cv::Mat& first, const cv::Mat& second) const {
  const cv::Ptr<cv::StereoSGBM> matcher = makeMatcher(view_, options_);
  // The matcher leaves out as many columns on the left as it tries disparities, near walls or not.
  const int margin_px = matcher->getNumDisparities();
  cv::Mat wide_first, wide_second, wide;
  cv::copyMakeBorder(first, wide_first, 0, 0, margin_px, 0, cv::BORDER_CONSTANT);
  cv::copyMakeBorder(second, wide_second, 0, 0, margin_px, 0, cv::BORDER_CONSTANT);
  matcher->compute(wide_first, wide_second, wide);
  cv::Mat whole;
  wide.colRange(margin_px, wide.cols).convertTo(whole, CV_32F, 1.0 / 16.0);
  whole.setTo(-1.0, whole <= 0.0F);
  const auto [disparities, sigmas] = refineDisparity(first, second, whole);
  const cv::Mat texture = textureOf(first);
  DepthImage result(first.size());
  for (int v = 0; v < first.rows; ++v) {
    for (int u = 0; u < first.cols; ++u) {
      const double disparity_px = disparities.at<float>(v, u);
      if (disparity_px <= 0.0 || view_.seen(0).at<uint8_t>(v, u) == 0) continue;
      if (texture.at<float>(v, u) < options_.min_texture) continue;
      const double sigma_m = view_.depthPerDisparity(u, v, disparity_px) * sigmas.at<float>(v, u);
      if (!(sigma_m <= options_.max_sigma_m)) continue;
      const double depth_m = view_.depth_m(u, v, disparity_px);
      if (!(depth_m >= options_.nearest_m && depth_m <= DepthImage::kMaxDepth_m)) continue;
      result.set(u, v, depth_m, sigma_m);
    }
  }
  return result;
}

}  // namespace lodeline
