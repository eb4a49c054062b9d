#include "lodeline/mapping/recognition/keypoints/blob_detector.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace lodeline {
namespace {
}  // namespace

std::vector<Keypoint> detectBlobs(const EvenedImage& image, const cv::Mat& visible, int most) {
  static const bool kHalf = env("R_HALF", 0.0) > 0;
  static const auto sift = cv::SIFT::create(0, 3, env("R_CONTRAST", 0.03), env("R_EDGE", 10.0), env("R_SIGMA", 1.6));
  static const double kMinSize = env("R_MINSIZE", 0.0);
  std::vector<cv::KeyPoint> found;
  cv::Mat in = image.grey;
  if (kHalf) cv::resize(in, in, {}, 0.5, 0.5, cv::INTER_AREA);
  sift->detect(in, found);
  if (kHalf) for (auto& p : found) { p.pt = (p.pt + cv::Point2f(0.5f, 0.5f)) * 2.0f - cv::Point2f(0.5f, 0.5f); p.size *= 2; }
  std::stable_sort(found.begin(), found.end(),
                   [](const cv::KeyPoint& a, const cv::KeyPoint& b) { return a.response > b.response; });
  constexpr int kBorder = 12;
  constexpr int kColumns = 8, kRows = 6;
  const int quota = 2 * most / (kColumns * kRows);
  std::map<int, int> in_cell;
  std::vector<Keypoint> result;
  cv::Mat taken(image.grey.size(), CV_8U, cv::Scalar(0));
  for (const cv::KeyPoint& point : found) {
    if (static_cast<int>(result.size()) >= most) break;
    const cv::Point at(cvRound(point.pt.x), cvRound(point.pt.y));
    if (at.x < kBorder || at.y < kBorder || at.x >= in.cols * (kHalf ? 2 : 1) - kBorder || at.y >= in.rows * (kHalf ? 2 : 1) - kBorder) continue;
    if (point.size < kMinSize) continue;
    if (taken.at<uint8_t>(at)) continue;
    int& count = in_cell[at.y * kRows / image.grey.rows * kColumns + at.x * kColumns / image.grey.cols];
    if (count >= quota) continue;
    const Vec2 pixel = image.toRecorded(Vec2(point.pt.x, point.pt.y));
    if (!visible.empty() && visible.at<uint8_t>(cvRound(pixel.y()), cvRound(pixel.x())) == 0) continue;
    ++count;
    cv::circle(taken, at, 1, cv::Scalar(255), cv::FILLED);
    result.push_back({pixel, static_cast<double>(point.size), static_cast<double>(point.response)});
  }
  return result;
}

}  // namespace lodeline
