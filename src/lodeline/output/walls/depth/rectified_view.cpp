#include "lodeline/output/walls/depth/rectified_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "lodeline/frontend/detection/mask.h"

namespace lodeline {

RectifiedView::RectifiedView(const std::vector<CameraCalibration>& calibrations,
                             const RectificationOptions& options) {
  place(calibrations);
  const double max_tangent = std::tan(options.max_angle_rad);
  std::vector<std::shared_ptr<const Camera>> cameras;
  std::vector<Rigid3> view_from_cameras;
  for (const CameraCalibration& calibration : calibrations) {
    cameras.push_back(makeCamera(calibration));
    view_from_cameras.push_back(body_from_view_.inverse() * calibration.body_from_camera);
  }
  const Window window = windowOf(*cameras[0], view_from_cameras[0], max_tangent);
  const Vec2 size = window.high - window.low;
  if (!(size.minCoeff() > 0.1)) {
    throw InputError(fmt::format("{}: its images cannot be rectified with those of the other camera",
                                 calibrations[0].name));
  }
  const double own_px = cameras[0]->focalLengthsOnAxis_px().mean();
  pinhole_.focal_px = std::min(own_px, options.max_width_px / size.x());
  pinhole_.width_px = static_cast<int>(size.x() * pinhole_.focal_px);
  pinhole_.height_px = static_cast<int>(size.y() * pinhole_.focal_px);
  pinhole_.centre_px = -window.low * pinhole_.focal_px;
  for (size_t i = 0; i < cameras.size(); ++i) {
    cameras_.push_back(rectification(*cameras[i], view_from_cameras[i], options.nominal_distance_m));
    const cv::Mat mask = loadMask(calibrations[i]);
    if (mask.empty()) continue;
    cv::Mat allowed;
    cv::remap(mask, allowed, cameras_[i].map_x, cameras_[i].map_y, cv::INTER_NEAREST, cv::BORDER_CONSTANT);
    cameras_[i].seen.setTo(0, allowed == 0);
  }
}

void RectifiedView::place(const std::vector<CameraCalibration>& calibrations) {
  body_from_view_ = calibrations[0].body_from_camera;
  if (calibrations.size() < 2) return;
  const Rigid3& second = calibrations[1].body_from_camera;
  const Vec3 baseline_B = second.translation - body_from_view_.translation;
  baseline_m_ = baseline_B.norm();
  const Vec3 axes_B = body_from_view_.rotation * Vec3::UnitZ() + second.rotation * Vec3::UnitZ();
  const Vec3 x_B = baseline_B / std::max(baseline_m_, 1e-9);
  const Vec3 z_B = axes_B - axes_B.dot(x_B) * x_B;
  if (baseline_m_ < 1e-3 || axes_B.norm() < 1.0 || z_B.norm() < 0.5 * axes_B.norm()) {
    throw InputError(
        fmt::format("{} and {}: no pair for depth: they must look the same way and stand beside each other",
                    calibrations[0].name, calibrations[1].name));
  }
  Mat3 axes;
  axes.col(0) = x_B;
  axes.col(2) = z_B.normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  body_from_view_.rotation = Quat(axes).normalized();
}

RectifiedView::Window RectifiedView::windowOf(const Camera& camera, const Rigid3& view_from_camera,
                                              double max_tangent) const {
  constexpr int kSteps = 32;
  Window window;
  const CameraCalibration& calibration = camera.calibration();
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const Vec2 pixel((calibration.width_px - 1.0) * column / kSteps,
                       (calibration.height_px - 1.0) * row / kSteps);
      const auto ray_C = camera.unproject(pixel);
      if (!ray_C) continue;
      const Vec3 ray_V = view_from_camera.rotation * *ray_C;
      if (ray_V.z() < 0.1) continue;
      const Vec2 point = ray_V.head<2>() / ray_V.z();
      const Vec2 limited = point.cwiseMax(-max_tangent).cwiseMin(max_tangent);
      window.low = window.low.cwiseMin(limited);
      window.high = window.high.cwiseMax(limited);
    }
  }
  return window;
}

RectifiedView::Rectified RectifiedView::rectification(const Camera& camera, const Rigid3& view_from_camera,
                                                      double distance_m) const {
  const cv::Size size(pinhole_.width_px, pinhole_.height_px);
  Rectified result{cv::Mat(size, CV_32F, -1.0F), cv::Mat(size, CV_32F, -1.0F), cv::Mat(size, CV_8U, 0.0),
                   cv::Mat(size, CV_64FC2, cv::Scalar(0.0, 0.0))};
  const Quat camera_from_view = view_from_camera.rotation.conjugate();
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      // From this camera's lens centre: parallel to the ray of the view.
      const Vec3 point_C = camera_from_view * (distance_m * pinhole_.direction(u, v));
      const auto pixel = camera.project(point_C);
      if (!pixel || !camera.contains(*pixel)) continue;
      const auto line = camera.viewRay(*pixel);
      if (!line) continue;
      const Vec3 origin_V = view_from_camera * line->origin_C;
      const Vec3 direction_V = view_from_camera.rotation * line->direction_C;
      if (direction_V.z() < 0.05) continue;
      const double slope = direction_V.x() / direction_V.z();
      result.map_x.at<float>(v, u) = static_cast<float>(pixel->x());
      result.map_y.at<float>(v, u) = static_cast<float>(pixel->y());
      result.seen.at<uint8_t>(v, u) = 255;
      result.lines.at<cv::Vec2d>(v, u) = {origin_V.x() - slope * origin_V.z(), slope};
    }
  }
  return result;
}

cv::Mat RectifiedView::rectify(size_t camera, const cv::Mat& image) const {
  cv::Mat rectified;
  cv::remap(image, rectified, cameras_[camera].map_x, cameras_[camera].map_y, cv::INTER_LINEAR,
            cv::BORDER_CONSTANT);
  return rectified;
}

Vec2 RectifiedView::lineDifference(int u, int v, double disparity_px) const {
  const double column = u - disparity_px;
  const int left = static_cast<int>(std::floor(column));
  if (left < 0 || left + 1 >= pinhole_.width_px) return Vec2::Zero();
  const cv::Mat& seen = cameras_[1].seen;
  if (seen.at<uint8_t>(v, left) == 0 || seen.at<uint8_t>(v, left + 1) == 0) return Vec2::Zero();
  const double share = column - left;
  const cv::Vec2d first = cameras_[0].lines.at<cv::Vec2d>(v, u);
  const cv::Vec2d second = (1.0 - share) * cameras_[1].lines.at<cv::Vec2d>(v, left) +
                           share * cameras_[1].lines.at<cv::Vec2d>(v, left + 1);
  return {second[0] - first[0], first[1] - second[1]};
}

double RectifiedView::depth_m(int u, int v, double disparity_px) const {
  const Vec2 difference = lineDifference(u, v, disparity_px);
  if (!(difference.y() > 1e-6)) return std::numeric_limits<double>::infinity();
  return difference.x() / difference.y();
}

double RectifiedView::depthPerDisparity(int u, int v, double disparity_px) const {
  const Vec2 difference = lineDifference(u, v, disparity_px);
  if (!(difference.y() > 1e-6)) return std::numeric_limits<double>::infinity();
  return std::abs(difference.x()) / (difference.y() * difference.y() * pinhole_.focal_px);
}

}  // namespace lodeline
