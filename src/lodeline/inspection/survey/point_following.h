#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "lodeline/geometry/types.h"

namespace lodeline {

/// Where one point lies in two images, px.
struct PointPair {
  Vec2 first, second;
};

/// Finds points of one image in another, by pyramidal Lucas-Kanade there and back: what does not return to
/// where it came from is left out. 8-bit grey images of the same size.
std::vector<PointPair> followPoints(const cv::Mat& first, const cv::Mat& second,
                                    const std::vector<cv::Point2f>& points);

}  // namespace lodeline
