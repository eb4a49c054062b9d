#include "lodeline/board/corner_refinement.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace lodeline {

std::optional<Vec2> refinedCorner(const cv::Mat& image, const Vec2& start, double gap_px) {
  // The window must not see the next corner, and its blur.
  const int reach = std::clamp(static_cast<int>(std::lround(0.75 * gap_px)), 2, 7);
  const double border_px = reach + 2.0;
  if (!(start.x() > border_px && start.y() > border_px && start.x() < image.cols - 1 - border_px &&
        start.y() < image.rows - 1 - border_px)) {
    return std::nullopt;
  }
  std::vector<cv::Point2f> corner = {
      cv::Point2f(static_cast<float>(start.x()), static_cast<float>(start.y()))};
  cv::cornerSubPix(image, corner, cv::Size(reach, reach), cv::Size(-1, -1),
                   cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 1e-3));
  const Vec2 refined(corner[0].x, corner[0].y);
  // cornerSubPix gives the start back where it did not find anything within its window.
  const double moved_px = (refined - start).norm();
  if (!refined.allFinite() || moved_px > 0.8 * reach || moved_px == 0.0) return std::nullopt;
  return refined;
}

}  // namespace lodeline
