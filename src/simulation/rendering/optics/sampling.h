#pragma once

#include <algorithm>
#include <opencv2/core.hpp>

#include "simulation/rendering/optics/render_types.h"

namespace lodeline {

/// Value of a CV_32F image between its pixels; beyond the border, that of the border.
inline float bilinear(const cv::Mat& image, float x, float y) {
  x = std::clamp(x, 0.0f, static_cast<float>(image.cols) - 1.001f);
  y = std::clamp(y, 0.0f, static_cast<float>(image.rows) - 1.001f);
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  const float fx = x - ix, fy = y - iy;
  const float* upper = image.ptr<float>(iy) + ix;
  const float* lower = image.ptr<float>(iy + 1) + ix;
  return lerp(lerp(upper[0], upper[1], fx), lerp(lower[0], lower[1], fx), fy);
}

}  // namespace lodeline
