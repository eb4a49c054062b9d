#include "lodeline/inspection/survey/point_following.h"

#include <opencv2/video/tracking.hpp>

namespace lodeline {

std::vector<PointPair> followPoints(const cv::Mat& first, const cv::Mat& second,
                                    const std::vector<cv::Point2f>& points) {
  constexpr int kPyramidLevels = 4;
  constexpr double kForwardBackward_px = 0.7, kLeastEigenvalue = 1e-6;
  std::vector<PointPair> pairs;
  if (points.empty()) return pairs;
  std::vector<cv::Point2f> forward, back;
  std::vector<uint8_t> found, found_back;
  const cv::Size window(21, 21);
  const cv::TermCriteria enough(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 0.01);
  cv::calcOpticalFlowPyrLK(first, second, points, forward, found, cv::noArray(), window, kPyramidLevels,
                           enough, 0, kLeastEigenvalue);
  cv::calcOpticalFlowPyrLK(second, first, forward, back, found_back, cv::noArray(), window, kPyramidLevels,
                           enough, 0, kLeastEigenvalue);
  for (size_t i = 0; i < points.size(); ++i) {
    if (!found[i] || !found_back[i] || cv::norm(back[i] - points[i]) > kForwardBackward_px) continue;
    pairs.push_back({Vec2(points[i].x, points[i].y), Vec2(forward[i].x, forward[i].y)});
  }
  return pairs;
}

}  // namespace lodeline
