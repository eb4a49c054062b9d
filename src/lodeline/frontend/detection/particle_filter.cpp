#include "lodeline/frontend/detection/particle_filter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lodeline/frontend/detection/structure_tensor.h"

namespace lodeline {
namespace {

constexpr int kRingRadiusPx = kParticleReachPx - StructureTensor::kWindowRadius;
constexpr int kRingPoints = 16;

/// Offsets of points on a circle, px.
std::array<cv::Point, kRingPoints> circle() {
  constexpr double kPi = 3.14159265358979323846;
  std::array<cv::Point, kRingPoints> points;
  for (int i = 0; i < kRingPoints; ++i) {
    const double angle = 2.0 * kPi * i / kRingPoints;
    points[static_cast<size_t>(i)] =
        cv::Point(static_cast<int>(std::lround(kRingRadiusPx * std::cos(angle))),
                  static_cast<int>(std::lround(kRingRadiusPx * std::sin(angle))));
  }
  return points;
}

cv::Point brightestNear(const cv::Mat& image, const cv::Point& corner) {
  constexpr int kReach = StructureTensor::kWindowRadius;
  cv::Point best = corner;
  for (int y = corner.y - kReach; y <= corner.y + kReach; ++y) {
    for (int x = corner.x - kReach; x <= corner.x + kReach; ++x) {
      if (image.at<float>(y, x) > image.at<float>(best)) best = cv::Point(x, y);
    }
  }
  return best;
}

}  // namespace

bool isParticle(const cv::Mat& image, const cv::Point& corner) {
  // Minimum height of a dot above the background, in multiples of the background's largest deviation from its
  // trend. The background of a rock corner has two brightnesses, and the corner exceeds it by a factor of
  // one.
  constexpr float kProminence = 3.0F;
  static const std::array<cv::Point, kRingPoints> kCircle = circle();
  const cv::Point centre = brightestNear(image, corner);
  float mean = 0.0F, slope_x = 0.0F, slope_y = 0.0F, reach = 0.0F;
  for (const cv::Point& offset : kCircle) {
    const float value = image.at<float>(centre + offset);
    mean += value / kRingPoints;
    slope_x += value * static_cast<float>(offset.x);
    slope_y += value * static_cast<float>(offset.y);
    reach += 0.5F * static_cast<float>(offset.dot(offset));
  }
  float ground = 0.0F;
  for (const cv::Point& offset : kCircle) {
    const float trend =
        (slope_x * static_cast<float>(offset.x) + slope_y * static_cast<float>(offset.y)) / reach;
    ground = std::max(ground, std::abs(image.at<float>(centre + offset) - mean - trend));
  }
  return image.at<float>(centre) - mean > kProminence * ground;
}

}  // namespace lodeline
