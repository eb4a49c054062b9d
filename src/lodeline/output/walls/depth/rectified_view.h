#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "lodeline/cameras/camera.h"

namespace lodeline {

struct RectificationOptions {
  int max_width_px = 640;       ///< of the view; larger images are reduced
  double max_angle_rad = 0.87;  ///< 50 degrees to the axis of the view, in each direction
  /// Distance of the points that are rectified exactly behind a port, m.
  double nominal_distance_m = 2.0;
};

/// A pinhole camera of the view frame V (z forward).
struct PinholeView {
  int width_px = 0, height_px = 0;
  double focal_px = 0.0;
  Vec2 centre_px = Vec2::Zero();  ///< pixel centres have integer coordinates

  /// Point of V with z = 1.
  Vec3 direction(double u, double v) const {
    return {(u - centre_px.x()) / focal_px, (v - centre_px.y()) / focal_px, 1.0};
  }
};

/// Images of one or two cameras of any model, behind any port, as images of one pinhole camera with the same
/// rotation. V has its origin in the first camera's lens centre. With two cameras, x points to the second
/// one. A point has the same row in both images, and a smaller column in the second one. With one camera, V
/// is its frame.
class RectifiedView {
 public:
  /// `cameras`: one or two. Throws InputError where the two cameras do not look the same way, or lie behind
  /// each other.
  RectifiedView(const std::vector<CameraCalibration>& cameras, const RectificationOptions& options);

  const PinholeView& pinhole() const { return pinhole_; }
  const Rigid3& body_from_view() const { return body_from_view_; }
  double baseline_m() const { return baseline_m_; }

  /// The image of one camera in the view; black where the camera saw nothing. Any number of channels.
  cv::Mat rectify(size_t camera, const cv::Mat& image) const;
  /// 8-bit, 255 where the camera saw something and its mask allows it.
  const cv::Mat& seen(size_t camera) const { return cameras_[camera].seen; }

  /// z of the point that the first camera sees in (u, v) and the second one in (u - disparity_px, v), m. The
  /// lines of sight are exact, also behind a port. Infinite where they do not meet in front of the cameras.
  double depth_m(int u, int v, double disparity_px) const;
  /// Derivative of the depth by the disparity, m/px, positive.
  double depthPerDisparity(int u, int v, double disparity_px) const;

 private:
  struct Rectified {
    cv::Mat map_x, map_y;  ///< CV_32F, pixel of the camera
    cv::Mat seen;
    cv::Mat lines;  ///< CV_64FC2: (p, q), with x = p + q z on the line of sight in V
  };
  /// The plane of V that the cameras see, at z = 1.
  struct Window {
    Vec2 low = Vec2::Constant(1e9), high = Vec2::Constant(-1e9);
  };

  void place(const std::vector<CameraCalibration>& calibrations);
  Window windowOf(const Camera& camera, const Rigid3& view_from_camera, double max_tangent) const;
  Rectified rectification(const Camera& camera, const Rigid3& view_from_camera, double distance_m) const;
  /// Difference of q of both lines, and of their p.
  Vec2 lineDifference(int u, int v, double disparity_px) const;

  PinholeView pinhole_;
  Rigid3 body_from_view_;
  double baseline_m_ = 0.0;
  std::vector<Rectified> cameras_;
};

}  // namespace lodeline
