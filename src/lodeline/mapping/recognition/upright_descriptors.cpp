#include "lodeline/mapping/recognition/upright_descriptors.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numbers>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace lodeline {
namespace {

constexpr int kElements = 128;

/// Two bits for each of the 128 elements: whether it exceeds the median of all, and their upper quartile.
Descriptor binarized(const float* elements) {
  std::array<float, kElements> sorted;
  std::copy_n(elements, kElements, sorted.begin());
  const auto middle = sorted.begin() + kElements / 2, quarter = sorted.begin() + 3 * kElements / 4;
  std::nth_element(sorted.begin(), middle, sorted.end());
  const float median = *middle;
  std::nth_element(middle, quarter, sorted.end());
  const float upper = *quarter;
  Descriptor descriptor;
  for (size_t i = 0; i < kElements; ++i) {
    descriptor.bits[i / 64] |= static_cast<uint64_t>(elements[i] > median) << (i % 64);
    descriptor.bits[2 + i / 64] |= static_cast<uint64_t>(elements[i] > upper) << (i % 64);
  }
  return descriptor;
}

}  // namespace

std::vector<std::optional<Descriptor>> uprightDescriptors(const EvenedImage& image,
                                                          const std::vector<PointToDescribe>& points) {
  static const double kMagnify = env("R_MAG", 1.0);
  std::vector<cv::KeyPoint> keypoints;
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec2 at = image.fromRecorded(points[i].pixel);
    const double direction_rad = points[i].up_rad.value_or(0.0);
    const double size = points[i].size_px * kMagnify;
    // octave and layer whose blur is nearest: sigma = 1.6 * 2^(octave + layer / 3) with size = 2 sigma
    const double level = 3.0 * std::log2(std::max(0.5 * size / 1.6, 1.0));
    int k = std::clamp(static_cast<int>(std::lround(level)), 0, 11);
    const int octave = k / 3, layer = k % 3;
    cv::KeyPoint p(cv::Point2f(static_cast<float>(at.x()), static_cast<float>(at.y())), static_cast<float>(size),
                   static_cast<float>(direction_rad * 180.0 / std::numbers::pi), 0.0F, octave | (layer << 8), static_cast<int>(i));
    if (p.angle < 0) p.angle += 360.0F;
    const double reach = 3.0 * 0.5 * size * 2.0;
    if (at.x() < reach || at.y() < reach || at.x() > image.grey.cols - 1 - reach || at.y() > image.grey.rows - 1 - reach) continue;
    keypoints.push_back(p);
  }
  std::vector<std::optional<Descriptor>> result(points.size());
  if (keypoints.empty()) return result;
  static const auto sift = cv::SIFT::create(0, 3);
  cv::Mat rows;
  sift->compute(image.grey, keypoints, rows);
  for (size_t k = 0; k < keypoints.size(); ++k)
    result[static_cast<size_t>(keypoints[k].class_id)] = binarized(rows.ptr<float>(static_cast<int>(k)));
  return result;
}

}  // namespace lodeline
