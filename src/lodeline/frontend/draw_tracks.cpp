#include "lodeline/frontend/draw_tracks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace lodeline {
namespace {

/// Sub-pixel positions in OpenCV's fixed-point drawing.
constexpr int kShift = 4;

cv::Point fixedPoint(const Eigen::Vector2f& pixel) {
  return {static_cast<int>(std::lround(pixel.x() * (1 << kShift))),
          static_cast<int>(std::lround(pixel.y() * (1 << kShift)))};
}

/// Colours of all levels at once, because OpenCV computes its colour map at every call.
cv::Mat turboColours() {
  cv::Mat levels(256, 1, CV_8U);
  for (int i = 0; i < 256; ++i) levels.at<uint8_t>(i) = static_cast<uint8_t>(i);
  cv::Mat colours;
  cv::applyColorMap(levels, colours, cv::COLORMAP_TURBO);
  return colours;
}

cv::Scalar colourOfAge(int observations, int old_observations) {
  static const cv::Mat colours = turboColours();
  const double age =
      std::clamp(static_cast<double>(observations - 1) / std::max(1, old_observations - 1), 0.0, 1.0);
  const auto& bgr = colours.at<cv::Vec3b>(static_cast<int>(std::lround(30.0 + 210.0 * age)));
  return {static_cast<double>(bgr[0]), static_cast<double>(bgr[1]), static_cast<double>(bgr[2])};
}

void drawDot(cv::Mat& picture, const Eigen::Vector2f& pixel, const cv::Scalar& colour) {
  cv::circle(picture, fixedPoint(pixel), 4 << kShift, cv::Scalar::all(0), 2, cv::LINE_AA, kShift);
  cv::circle(picture, fixedPoint(pixel), 3 << kShift, colour, cv::FILLED, cv::LINE_AA, kShift);
}

}  // namespace

cv::Mat drawTracks(const FrontEnd& front_end, const std::vector<cv::Mat>& images, int old_observations) {
  constexpr int kBarPx = 24;
  const auto& cameras = front_end.cameras();
  std::vector<int> lefts;
  cv::Size size(0, 0);
  for (size_t i = 0; i < cameras.size() && i < images.size(); ++i) {
    const CameraCalibration& camera = cameras[i]->calibration();
    lefts.push_back(size.width);
    size.width += camera.width_px;
    size.height = std::max(size.height, camera.height_px);
  }
  cv::Mat picture(size.height + kBarPx, size.width, CV_8UC3, cv::Scalar::all(0));
  for (size_t i = 0; i < lefts.size(); ++i) {
    if (images[i].empty()) continue;
    cv::Mat part = picture(cv::Rect(cv::Point(lefts[i], 0), images[i].size()));
    cv::cvtColor(images[i], part, cv::COLOR_GRAY2BGR);
    const cv::Mat& moving = front_end.fixedStructures()[i].mask();
    if (!moving.empty()) cv::Mat(part / 3).copyTo(part, moving == 0);
  }
  for (const Track& track : front_end.tracks()) {
    const cv::Scalar colour = colourOfAge(track.observations, old_observations);
    drawDot(picture, track.warp.position, colour);
    for (size_t m = 0; m < track.matches.size() && m + 1 < lefts.size(); ++m) {
      if (!track.matches[m]) continue;
      const Eigen::Vector2f offset(static_cast<float>(lefts[m + 1]), 0.0F);
      drawDot(picture, track.matches[m]->position + offset, colour);
    }
  }
  const FrontEndStatistics& s = front_end.statistics();
  const std::string line = fmt::format("{} tracks ({} new, {} lost, {} rejected), {} matched, image {}",
                                       s.tracks(), s.created, s.lost, s.rejected, s.matched, s.image.word);
  cv::putText(picture, line, {8, size.height + 17}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar::all(255), 1,
              cv::LINE_AA);
  return picture;
}

}  // namespace lodeline
