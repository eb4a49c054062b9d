#include "lodeline/mapping/recognition/keypoints/blob_detector.h"

#include <algorithm>
#include <array>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace lodeline {
namespace {

/// Blobs of the half-size image, strongest first, px of the evened image. The detector doubles its input, so
/// its finest scale is that of the evened image, smoothed.
std::vector<cv::Point2f> strongestFirst(const cv::Mat& evened) {
  constexpr int kLayers = 3;
  constexpr double kLeastContrast = 0.01, kEdge = 10.0, kSigma_px = 1.6;
  cv::Mat half;
  cv::resize(evened, half, {}, 0.5, 0.5, cv::INTER_AREA);
  std::vector<cv::KeyPoint> found;
  cv::SIFT::create(0, kLayers, kLeastContrast, kEdge, kSigma_px)->detect(half, found);
  std::stable_sort(found.begin(), found.end(),
                   [](const cv::KeyPoint& a, const cv::KeyPoint& b) { return a.response > b.response; });
  std::vector<cv::Point2f> pixels;
  // The detector's doubling moves pixels by a quarter, and halving by half a pixel of the evened image: both
  // cancel.
  for (const cv::KeyPoint& blob : found) pixels.emplace_back(2.0F * blob.pt.x, 2.0F * blob.pt.y);
  return pixels;
}

/// Lets each part of an image have twice its share of the points, and no point next to another.
class Spread {
 public:
  Spread(cv::Size size, int most)
      : size_(size), quota_(std::max(1, 2 * most / (kColumns * kRows))), taken_(size, CV_8U, cv::Scalar(0)) {}

  bool take(const cv::Point& at) {
    int& count =
        counts_[static_cast<size_t>(at.y * kRows / size_.height * kColumns + at.x * kColumns / size_.width)];
    if (count >= quota_ || taken_.at<uint8_t>(at) != 0) return false;
    ++count;
    cv::circle(taken_, at, 1, cv::Scalar(1), cv::FILLED);
    return true;
  }

 private:
  static constexpr int kColumns = 8, kRows = 6;
  cv::Size size_;
  int quota_;
  std::array<int, kColumns * kRows> counts_{};
  cv::Mat taken_;
};

}  // namespace

std::vector<Vec2> detectBlobs(const EvenedImage& image, const cv::Mat& visible, int most) {
  constexpr int kBorder_px = 12;
  const cv::Rect inside(kBorder_px, kBorder_px, image.grey.cols - 2 * kBorder_px,
                        image.grey.rows - 2 * kBorder_px);
  if (inside.width <= 0 || inside.height <= 0) return {};
  Spread spread(image.grey.size(), most);
  std::vector<Vec2> blobs;
  for (const cv::Point2f& blob : strongestFirst(image.grey)) {
    if (static_cast<int>(blobs.size()) >= most) break;
    const cv::Point at(cvRound(blob.x), cvRound(blob.y));
    if (!inside.contains(at)) continue;
    const Vec2 pixel = image.toRecorded(Vec2(blob.x, blob.y));
    if (!visible.empty() && visible.at<uint8_t>(cvRound(pixel.y()), cvRound(pixel.x())) == 0) continue;
    if (spread.take(at)) blobs.push_back(pixel);
  }
  return blobs;
}

}  // namespace lodeline
