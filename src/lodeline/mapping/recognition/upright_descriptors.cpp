#include "lodeline/mapping/recognition/upright_descriptors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace lodeline {
namespace {

constexpr size_t kElements = 128;
constexpr int kLayers = 3;  // in which the smoothing doubles
constexpr double kFinest_px = 1.6;

/// Element of a rank, 0 for the smallest.
float elementOfRank(std::array<float, kElements> elements, size_t rank) {
  std::nth_element(elements.begin(), elements.begin() + static_cast<ptrdiff_t>(rank), elements.end());
  return elements[rank];
}

Descriptor binarized(const float* row) {
  std::array<float, kElements> elements;
  std::copy_n(row, kElements, elements.begin());
  const float median = elementOfRank(elements, kElements / 2);
  const float quartile = elementOfRank(elements, 3 * kElements / 4);
  Descriptor descriptor;
  for (size_t i = 0; i < kElements; ++i) {
    descriptor.bits[i / 64] |= static_cast<uint64_t>(elements[i] > median) << (i % 64);
    descriptor.bits[2 + i / 64] |= static_cast<uint64_t>(elements[i] > quartile) << (i % 64);
  }
  return descriptor;
}

/// The number by which OpenCV finds the image of the pyramid that is smoothed like the patch.
int pyramidImage(double sigma_px) {
  constexpr int kCoarsest = 4 * kLayers - 1;
  const double level = kLayers * std::log2(std::max(sigma_px / kFinest_px, 1.0));
  const int nearest = std::min(static_cast<int>(std::lround(level)), kCoarsest);
  return nearest / kLayers | (nearest % kLayers) << 8;
}

/// Direction of the intensity centroid of a disc, rad (Rublee et al., "ORB: an efficient alternative to SIFT
/// or SURF", ICCV 2011, section 3.2). The disc must be in the image.
double centroidDirection(const cv::Mat& grey, const Vec2& centre, int radius_px) {
  constexpr double kMean_grey = 128.0;
  const int u = static_cast<int>(std::lround(centre.x())), v = static_cast<int>(std::lround(centre.y()));
  double moment_x = 0.0, moment_y = 0.0;
  for (int y = -radius_px; y <= radius_px; ++y) {
    const auto* row = grey.ptr<uint8_t>(v + y);
    for (int x = -radius_px; x <= radius_px; ++x) {
      if (x * x + y * y > radius_px * radius_px) continue;
      moment_x += x * (row[u + x] - kMean_grey);
      moment_y += y * (row[u + x] - kMean_grey);
    }
  }
  return std::atan2(moment_y, moment_x);
}

/// The point for OpenCV; empty where its patch is not in the image.
std::optional<cv::KeyPoint> keypointOf(const EvenedImage& image, const PointToDescribe& point) {
  constexpr double kReach_sigmas = 6.0;
  const Vec2 at = image.fromRecorded(point.pixel);
  const double reach_px = kReach_sigmas * point.sigma_px;
  if (!(at.minCoeff() >= reach_px && at.x() <= image.grey.cols - 1 - reach_px &&
        at.y() <= image.grey.rows - 1 - reach_px)) {
    return std::nullopt;
  }
  const double direction_rad =
      point.up_rad ? *point.up_rad : centroidDirection(image.grey, at, static_cast<int>(reach_px) - 1);
  double direction_deg = direction_rad * 180.0 / std::numbers::pi;
  if (direction_deg < 0.0) direction_deg += 360.0;
  return cv::KeyPoint(cv::Point2f(static_cast<float>(at.x()), static_cast<float>(at.y())),
                      static_cast<float>(2.0 * point.sigma_px), static_cast<float>(direction_deg), 0.0F,
                      pyramidImage(point.sigma_px));
}

}  // namespace

std::vector<std::optional<Descriptor>> uprightDescriptors(const EvenedImage& image,
                                                          const std::vector<PointToDescribe>& points) {
  std::vector<cv::KeyPoint> keypoints;
  for (size_t i = 0; i < points.size(); ++i) {
    auto keypoint = keypointOf(image, points[i]);
    if (!keypoint) continue;
    keypoint->class_id = static_cast<int>(i);
    keypoints.push_back(*keypoint);
  }
  std::vector<std::optional<Descriptor>> result(points.size());
  if (keypoints.empty()) return result;
  cv::Mat rows;
  cv::SIFT::create(0, kLayers)->compute(image.grey, keypoints, rows);
  for (size_t k = 0; k < keypoints.size(); ++k)
    result[static_cast<size_t>(keypoints[k].class_id)] = binarized(rows.ptr<float>(static_cast<int>(k)));
  return result;
}

}  // namespace lodeline
