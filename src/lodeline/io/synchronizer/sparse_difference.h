#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <opencv2/core/mat.hpp>

namespace lodeline {

/// Mean absolute difference of two 8-bit grey images of equal size, in grey levels, over every 16th row
/// (eight rows of small images).
inline double sparseDifference(const cv::Mat& a, const cv::Mat& b) {
  const int step = std::clamp(a.rows / 8, 1, 16);
  int64_t sum = 0, count = 0;
  for (int row = step / 2; row < a.rows; row += step) {
    const uint8_t* p = a.ptr<uint8_t>(row);
    const uint8_t* q = b.ptr<uint8_t>(row);
    int of_row = 0;
    for (int x = 0; x < a.cols; ++x) of_row += std::abs(int{p[x]} - int{q[x]});
    sum += of_row;
    count += a.cols;
  }
  return count == 0 ? 0.0 : static_cast<double>(sum) / static_cast<double>(count);
}

}  // namespace lodeline
