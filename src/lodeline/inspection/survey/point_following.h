#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Positions of one point in two images, px.
struct PointPair {
  Vec2 first, second;
};

/// Tracks points of one image in another by pyramidal Lucas-Kanade with a forward-backward check. 8-bit grey
/// images of the same size.
std::vector<PointPair> followPoints(const cv::Mat& first, const cv::Mat& second,
                                    const std::vector<cv::Point2f>& points);

}  // namespace lodeline
