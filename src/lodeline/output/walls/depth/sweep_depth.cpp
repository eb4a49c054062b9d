#include "lodeline/output/walls/depth/sweep_depth.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace lodeline {
namespace {

constexpr int kPlanes = 64;
constexpr int kCensusRadius = 2, kWindow_px = 7;
constexpr float kWorstCost = 24.0F;  ///< bits of the census

/// Bits by which the neighbours of each pixel are darker than it, CV_32S.
cv::Mat censusOf(const cv::Mat& grey) {
  cv::Mat census(grey.size(), CV_32S, cv::Scalar(0));
  for (int v = kCensusRadius; v < grey.rows - kCensusRadius; ++v) {
    for (int u = kCensusRadius; u < grey.cols - kCensusRadius; ++u) {
      const uint8_t middle = grey.at<uint8_t>(v, u);
      uint32_t bits = 0;
      for (int y = -kCensusRadius; y <= kCensusRadius; ++y) {
        const uint8_t* row = grey.ptr<uint8_t>(v + y) + u;
        for (int x = -kCensusRadius; x <= kCensusRadius; ++x) {
          if (x != 0 || y != 0) bits = 2 * bits + (row[x] < middle ? 1U : 0U);
        }
      }
      census.at<int32_t>(v, u) = static_cast<int32_t>(bits);
    }
  }
  return census;
}

/// Place of the lowest cost of a pixel between planes; nothing where it is not distinct or at the end.
std::optional<double> bestPlane(const std::vector<cv::Mat>& costs, int u, int v) {
  constexpr float kDistinct = 1.1F;
  constexpr int kSame = 3;
  std::array<float, kPlanes> values;
  for (int i = 0; i < kPlanes; ++i)
    values[static_cast<size_t>(i)] = costs[static_cast<size_t>(i)].at<float>(v, u);
  const auto best = std::min_element(values.begin(), values.end()) - values.begin();
  if (best == 0 || best + 1 == kPlanes || values[static_cast<size_t>(best)] > 0.4F * kWorstCost)
    return std::nullopt;
  for (int i = 0; i < kPlanes; ++i) {
    if (std::abs(i - best) < kSame) continue;
    if (values[static_cast<size_t>(i)] < kDistinct * values[static_cast<size_t>(best)]) return std::nullopt;
  }
  const auto at = [&](std::ptrdiff_t i) -> double { return values[static_cast<size_t>(i)]; };
  const double curvature = at(best - 1) - 2.0 * at(best) + at(best + 1);
  const double shift = curvature > 1e-6 ? 0.5 * (at(best - 1) - at(best + 1)) / curvature : 0.0;
  return static_cast<double>(best) + std::clamp(shift, -0.5, 0.5);
}

}  // namespace

SweepDepth::SweepDepth(const RectifiedView& view, const DepthImageOptions& options)
    : view_(view),
      options_(options),
      far_(1.0 / DepthImage::kMaxDepth_m),
      step_((1.0 / options.nearest_m - far_) / (kPlanes - 1)) {}

std::vector<SweepDepth::Neighbour> SweepDepth::placed(const SweepFrame& keyframe,
                                                      const std::vector<SweepFrame>& frames) const {
  std::vector<Neighbour> neighbours;
  for (const SweepFrame& frame : frames) {
    const Rigid3 neighbour_from_keyframe = frame.map_from_view.inverse() * keyframe.map_from_view;
    neighbours.push_back({neighbour_from_keyframe.rotation.toRotationMatrix(),
                          neighbour_from_keyframe.translation, frame.grey});
  }
  return neighbours;
}

cv::Mat SweepDepth::warped(const Neighbour& neighbour, double inverse_depth) const {
  const PinholeView& pinhole = view_.pinhole();
  Mat3 camera = Mat3::Identity();
  camera.diagonal().head<2>().setConstant(pinhole.focal_px);
  camera.col(2).head<2>() = pinhole.centre_px;
  Mat3 motion = neighbour.rotation;
  motion.col(2) += inverse_depth * neighbour.translation;
  const Mat3 homography = camera * motion * camera.inverse();
  cv::Matx33d matrix;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix(row, column) = homography(row, column);
  }
  cv::Mat result;
  cv::warpPerspective(neighbour.grey, result, matrix, neighbour.grey.size(),
                      cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT);
  return result;
}

cv::Mat SweepDepth::cost(const cv::Mat& census, const std::vector<Neighbour>& neighbours,
                         double inverse_depth) const {
  cv::Mat sum(census.size(), CV_32F, cv::Scalar(0));
  for (const Neighbour& neighbour : neighbours) {
    const cv::Mat grey = warped(neighbour, inverse_depth);
    const cv::Mat other = censusOf(grey);
    for (int v = 0; v < census.rows; ++v) {
      for (int u = 0; u < census.cols; ++u) {
        // Black is what the neighbour did not see.
        const auto differing = static_cast<uint32_t>(census.at<int32_t>(v, u) ^ other.at<int32_t>(v, u));
        sum.at<float>(v, u) +=
            grey.at<uint8_t>(v, u) == 0 ? kWorstCost : static_cast<float>(std::popcount(differing));
      }
    }
  }
  cv::Mat mean;
  cv::boxFilter(sum, mean, CV_32F, {kWindow_px, kWindow_px});
  return mean / static_cast<double>(neighbours.size());
}

double SweepDepth::parallax(const std::vector<Neighbour>& neighbours, int u, int v,
                            double inverse_depth) const {
  const Vec3 direction = view_.pinhole().direction(u, v);
  double largest = 0.0;
  for (const Neighbour& neighbour : neighbours) {
    const Vec3& t = neighbour.translation;
    const Vec3 point = neighbour.rotation * direction + inverse_depth * t;
    if (point.z() < 0.1) continue;
    const Vec2 moved = (t.head<2>() - t.z() / point.z() * point.head<2>()) / point.z();
    largest = std::max(largest, view_.pinhole().focal_px * moved.norm());
  }
  return largest;
}

DepthImage SweepDepth::compute(const SweepFrame& keyframe, const std::vector<SweepFrame>& before,
                               const std::vector<SweepFrame>& after) const {
  DepthImage result(keyframe.grey.size());
  std::vector<std::vector<Neighbour>> sides;
  for (const auto* frames : {&before, &after}) {
    if (!frames->empty()) sides.push_back(placed(keyframe, *frames));
  }
  if (sides.empty()) return result;
  const cv::Mat census = censusOf(keyframe.grey), texture = textureOf(keyframe.grey);
  std::vector<cv::Mat> costs;
  for (int plane = 0; plane < kPlanes; ++plane) {
    cv::Mat best = cost(census, sides.front(), inverseDepth(plane));
    if (sides.size() > 1) best = cv::min(best, cost(census, sides.back(), inverseDepth(plane)));
    costs.push_back(best);
  }
  for (int v = kWindow_px; v < census.rows - kWindow_px; ++v) {
    for (int u = kWindow_px; u < census.cols - kWindow_px; ++u) {
      if (view_.seen(0).at<uint8_t>(v, u) == 0 || texture.at<float>(v, u) < options_.min_texture) continue;
      const auto plane = bestPlane(costs, u, v);
      if (!plane) continue;
      const double inverse_depth = inverseDepth(*plane), depth_m = 1.0 / inverse_depth;
      double moves = 0.0;
      for (const auto& side : sides) moves = std::max(moves, parallax(side, u, v, inverse_depth));
      const double by_match = options_.disparity_sigma_px / std::max(moves, 1e-6);
      const double sigma_m = depth_m * depth_m * std::hypot(by_match, 0.25 * step_);
      if (sigma_m <= options_.max_sigma_m) result.set(u, v, depth_m, sigma_m);
    }
  }
  return result;
}

}  // namespace lodeline
