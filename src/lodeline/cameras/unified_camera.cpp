#include <fmt/format.h>

#include <cmath>

#include "lodeline/cameras/brown_conrady.h"
#include "lodeline/cameras/camera_model.h"
#include "lodeline/cameras/image_place.h"

namespace lodeline {
namespace {

/// Omnidirectional camera of a unit sphere. A point at the distance d has the position
///
///     (x, y) / (z + xi d)
///
/// in the plane of the sphere's projection. Brown-Conrady distortion (brown_conrady.h), the focal lengths and
/// the principal point turn it into a pixel. Source: C. Mei, P. Rives, "Single view point omnidirectional
/// camera calibration from planar grids", ICRA 2007. Model `omni` of Kalibr, `MEI` of VINS.
class UnifiedCamera final : public Camera {
 public:
  explicit UnifiedCamera(const CameraCalibration& calibration)
      : Camera(calibration), xi_(calibration.distortion.at(0)), distortion_(calibration.distortion, 1) {
    // The sphere's projection ends at an infinite radius for xi <= 1, and else where a ray is tangent to it.
    const double end_rad = std::acos(-(xi_ <= 1.0 ? xi_ : 1.0 / xi_));
    max_angle_rad_ = std::min(kWidestLens_rad, end_rad - kMarginToTheEnd_rad);
    const double radius = std::sin(max_angle_rad_) / (std::cos(max_angle_rad_) + xi_);
    if (radius > distortion_.maxRadius()) {
      const Vec3 last = lift(Vec2(distortion_.maxRadius(), 0.0));
      max_angle_rad_ = std::atan2(last.x(), last.z());
    }
    min_cosine_ = std::cos(max_angle_rad_);
  }

  std::optional<Vec2> project(const Vec3& point_C, Mat23* pixel_by_point,
                              PixelByParameters* pixel_by_parameters) const override {
    const double z = point_C.z(), distance = point_C.norm();
    if (!(distance > 0.0) || !(z >= min_cosine_ * distance)) return std::nullopt;
    const double inverse = 1.0 / (z + xi_ * distance);
    const Vec2 undistorted = point_C.head<2>() * inverse;
    Mat2 jacobian;
    const Vec2 distorted = distortion_.distort(undistorted, &jacobian);
    const CameraCalibration& c = calibration();
    const Vec2 focal_lengths_px(c.fx_px, c.fy_px);
    if (pixel_by_point) {
      Mat23 undistorted_by_point = -undistorted * (xi_ / distance * point_C + Vec3::UnitZ()).transpose();
      undistorted_by_point.leftCols<2>() += Mat2::Identity();
      *pixel_by_point = focal_lengths_px.asDiagonal() * (jacobian * (undistorted_by_point * inverse));
    }
    if (pixel_by_parameters) {
      setPinholeColumns(c, distorted, pixel_by_parameters);
      pixel_by_parameters->col(4) =
          focal_lengths_px.cwiseProduct(jacobian * undistorted) * (-distance * inverse);
      const auto count = static_cast<Eigen::Index>(c.distortion.size()) - 1;
      pixel_by_parameters->rightCols(count) =
          focal_lengths_px.asDiagonal() * distortion_.byCoefficients(undistorted).leftCols(count);
    }
    return focal_lengths_px.cwiseProduct(distorted) + Vec2(c.cx_px, c.cy_px);
  }

  std::optional<Vec3> unproject(const Vec2& pixel) const override {
    const std::optional<Vec2> undistorted = distortion_.undistort(placeOf(calibration(), pixel));
    if (!undistorted || 1.0 + (1.0 - xi_ * xi_) * undistorted->squaredNorm() < 0.0) return std::nullopt;
    const Vec3 ray = lift(*undistorted);
    if (!(ray.z() >= min_cosine_)) return std::nullopt;
    return ray;
  }

  double maxAngle_rad() const override { return max_angle_rad_; }

 private:
  /// Unit ray of a position in the plane of the sphere's projection.
  Vec3 lift(const Vec2& m) const {
    const double r2 = m.squaredNorm();
    const double length = (xi_ + std::sqrt(1.0 + (1.0 - xi_ * xi_) * r2)) / (1.0 + r2);
    return Vec3(length * m.x(), length * m.y(), length - xi_).normalized();
  }

  double xi_;
  BrownConrady distortion_;
  double max_angle_rad_ = 0.0, min_cosine_ = 0.0;
};

std::string unifiedFault(const std::vector<double>& p) {
  if (p[0] >= 0.0) return {};
  return fmt::format("xi of the unified model is {}; it must not be negative", p[0]);
}

}  // namespace

CameraModel unifiedModel() {
  return {
      .name = "unified",
      .projections = {"omni", "unified"},
      .distortions = {"radtan", "radial-tangential", "plumb_bob", "none", ""},
      .aliases = {"omni", "MEI"},
      .parameters = {"xi", "k1", "k2", "p1", "p2"},
      .counts = {1, 5},
      .before_focal_lengths = 1,
      .fault = unifiedFault,
      .make = [](const CameraCalibration& c) -> std::shared_ptr<const Camera> {
        return std::make_shared<UnifiedCamera>(c);
      },
      .typical = {0.55, {1.2, -0.15, 0.05, 3e-4, -2e-4}},
  };
}

}  // namespace lodeline
