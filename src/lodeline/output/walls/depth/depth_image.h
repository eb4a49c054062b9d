#pragma once

#include <opencv2/core.hpp>

#include "lodeline/output/walls/depth/rectified_view.h"

namespace lodeline {

/// Depths of a pinhole view with their uncertainty and colour. Zero is no depth.
struct DepthImage {
  static constexpr double kDepthUnit_m = 1e-4;
  static constexpr double kSigmaUnit_m = 1e-3;
  static constexpr double kMaxDepth_m = 6.5;

  cv::Mat depth;   ///< CV_16U, z in kDepthUnit_m
  cv::Mat sigma;   ///< CV_8U, one sigma in kSigmaUnit_m, at least 1 where there is a depth
  cv::Mat colour;  ///< CV_8U or CV_8UC3 (BGR)

  explicit DepthImage(cv::Size size = {})
      : depth(size, CV_16U, cv::Scalar(0)), sigma(size, CV_8U, cv::Scalar(0)) {}

  double depth_m(int u, int v) const { return kDepthUnit_m * depth.at<uint16_t>(v, u); }
  double sigma_m(int u, int v) const { return kSigmaUnit_m * sigma.at<uint8_t>(v, u); }
  void set(int u, int v, double depth_m, double sigma_m) {
    depth.at<uint16_t>(v, u) = cv::saturate_cast<uint16_t>(depth_m / kDepthUnit_m);
    sigma.at<uint8_t>(v, u) = cv::saturate_cast<uint8_t>(std::max(1.0, sigma_m / kSigmaUnit_m));
  }
  double share() const {
    return depth.empty() ? 0.0
                         : static_cast<double>(cv::countNonZero(depth)) / static_cast<double>(depth.total());
  }
};

/// Which depths are kept.
struct DepthImageOptions {
  double nearest_m = 0.5;           ///< nearer surfaces give no depth
  double max_sigma_m = 0.08;        ///< expected error of a depth by baseline and disparity
  double disparity_sigma_px = 0.3;  ///< one sigma of a match of the plane sweep
  double min_texture = 1.5;         ///< RMS gradient about a pixel, grey levels per px
};

/// RMS of the gradient in a window about each pixel, grey levels per px, CV_32F. `grey`: 8-bit.
cv::Mat textureOf(const cv::Mat& grey);

}  // namespace lodeline
