#include "lodeline/mapping/recognition/upright_descriptors.h"

#include <cstring>
#include <numbers>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace lodeline {
namespace {

constexpr int kPatch_px = 31;
constexpr float kHalving = 0.5F;

/// Direction of the intensity centroid of a disc, rad (Rublee et al. 2011, section 3.2).
double centroidDirection(const cv::Mat& half, const cv::Point2f& centre) {
  constexpr int kRadius = kPatch_px / 2;
  const int u = cvRound(centre.x), v = cvRound(centre.y);
  double moment_x = 0.0, moment_y = 0.0;
  for (int y = -kRadius; y <= kRadius; ++y) {
    const auto* row = half.ptr<uint8_t>(v + y);
    for (int x = -kRadius; x <= kRadius; ++x) {
      if (x * x + y * y > kRadius * kRadius) continue;
      moment_x += x * row[u + x];
      moment_y += y * row[u + x];
    }
  }
  return std::atan2(moment_y, moment_x);
}

}  // namespace

std::vector<std::optional<Descriptor>> uprightDescriptors(const cv::Mat& image,
                                                          const std::vector<PointToDescribe>& points) {
  cv::Mat half;
  cv::resize(image, half, {}, kHalving, kHalving, cv::INTER_AREA);
  // A turned patch reaches further than half its side.
  constexpr int kBorder = kPatch_px / 2 + 4;
  const cv::Rect2f inside(kBorder, kBorder, static_cast<float>(half.cols - 2 * kBorder - 1),
                          static_cast<float>(half.rows - 2 * kBorder - 1));
  std::vector<cv::KeyPoint> keypoints;
  for (size_t i = 0; i < points.size(); ++i) {
    // The centre of a pixel of the half-size image lies between two of the image.
    const cv::Point2f centre((static_cast<float>(points[i].pixel.x()) - 0.5F) * kHalving,
                             (static_cast<float>(points[i].pixel.y()) - 0.5F) * kHalving);
    if (!inside.contains(centre)) continue;
    const double direction_rad = points[i].up_rad ? *points[i].up_rad : centroidDirection(half, centre);
    const auto direction_deg = static_cast<float>(direction_rad * 180.0 / std::numbers::pi);
    keypoints.emplace_back(centre, static_cast<float>(kPatch_px), direction_deg, 0.0F, 0,
                           static_cast<int>(i));
  }
  std::vector<std::optional<Descriptor>> result(points.size());
  if (keypoints.empty()) return result;
  cv::Mat rows;
  const auto orb = cv::ORB::create(static_cast<int>(keypoints.size()), 2.0F, 1, kBorder - 2, 0, 2,
                                   cv::ORB::HARRIS_SCORE, kPatch_px);
  orb->compute(half, keypoints, rows);
  for (size_t k = 0; k < keypoints.size(); ++k) {
    Descriptor& descriptor = result[static_cast<size_t>(keypoints[k].class_id)].emplace();
    std::memcpy(descriptor.bits.data(), rows.ptr(static_cast<int>(k)), sizeof(descriptor.bits));
  }
  return result;
}

}  // namespace lodeline
