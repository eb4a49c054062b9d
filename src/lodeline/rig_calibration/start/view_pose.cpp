#include "lodeline/rig_calibration/start/view_pose.h"

#include <limits>
#include <opencv2/calib3d.hpp>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/median.h"

namespace lodeline {

std::optional<Rigid3> cameraFromBoard(const Camera& camera, const CalibrationBoard& board,
                                      const std::vector<BoardCorner>& corners) {
  constexpr double kLeastForward = 0.1;  // of a ray along the axis
  constexpr size_t kLeastCorners = 8;
  std::vector<cv::Point3d> on_board;
  std::vector<cv::Point2d> normalized;
  for (const BoardCorner& corner : corners) {
    const auto ray_C = camera.unproject(corner.pixel);
    if (!ray_C || ray_C->z() < kLeastForward) continue;
    const Vec3 corner_T = board.corner_T(corner.index);
    on_board.emplace_back(corner_T.x(), corner_T.y(), 0.0);
    normalized.emplace_back(ray_C->x() / ray_C->z(), ray_C->y() / ray_C->z());
  }
  if (on_board.size() < kLeastCorners) return std::nullopt;
  cv::Vec3d turn, shift;
  if (!cv::solvePnP(on_board, normalized, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), turn, shift, false,
                    cv::SOLVEPNP_IPPE)) {
    return std::nullopt;
  }
  const Rigid3 pose(so3::exp(Vec3(turn[0], turn[1], turn[2])), Vec3(shift[0], shift[1], shift[2]));
  if (!pose.translation.allFinite() || !pose.rotation.coeffs().allFinite()) return std::nullopt;
  return pose;
}

double medianError_px(const Camera& camera, const CalibrationBoard& board,
                      const std::vector<BoardCorner>& corners, const Rigid3& camera_from_board) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::vector<double> errors_px;
  for (const BoardCorner& corner : corners) {
    const auto pixel = camera.project(camera_from_board * board.corner_T(corner.index));
    errors_px.push_back(pixel ? (*pixel - corner.pixel).norm() : kNone);
  }
  if (errors_px.empty()) return kNone;
  return median(std::move(errors_px));
}

}  // namespace lodeline
