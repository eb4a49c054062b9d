#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/cameras/image_place.h"

namespace lodeline {
namespace {

/// Fisheye camera with one parameter w (rad), the field of view of an ideal lens of this kind. With
/// rho = sqrt(x^2 + y^2) the radius in the image, in units of the focal lengths, is
///
///     atan2(2 rho tan(w / 2), z) / w
///
/// Source: F. Devernay, O. Faugeras, "Straight lines have to be straight", MVA 2001. Distortion `fov` of
/// Kalibr, ATAN camera of PTAM.
class FieldOfViewCamera final : public Camera {
 public:
  explicit FieldOfViewCamera(const CameraCalibration& calibration)
      : Camera(calibration), w_rad_(calibration.distortion.at(0)), slope_(2.0 * std::tan(0.5 * w_rad_)) {
    const double half = std::cos(0.5 * w_rad_);
    slope_by_w_ = 1.0 / (half * half);
  }

  std::optional<Vec2> project(const Vec3& point_C, Mat23* pixel_by_point,
                              PixelByParameters* pixel_by_parameters) const override {
    const double z = point_C.z(), distance = point_C.norm();
    if (!(distance > 0.0) || !(z >= min_cosine_ * distance)) return std::nullopt;
    const double rho2 = point_C.head<2>().squaredNorm();
    const double rho = std::sqrt(rho2);
    const double q = slope_ * slope_ * rho2 + z * z;
    // `bend` is the derivative of the scale by rho, divided by rho.
    ImageScale image;
    double bend = 0.0;
    constexpr double kNearAxis = 1e-4;  // there the series is exact to machine precision
    if (slope_ * rho < kNearAxis * z) {
      image.scale = slope_ / (w_rad_ * z) * (1.0 - slope_ * slope_ * rho2 / (3.0 * z * z));
      bend = -2.0 * slope_ * slope_ * slope_ / (3.0 * w_rad_ * z * z * z);
    } else {
      image.scale = std::atan2(slope_ * rho, z) / (w_rad_ * rho);
      bend = (slope_ * z / (q * w_rad_) - image.scale) / rho2;
    }
    image.by_point = Vec3(bend * point_C.x(), bend * point_C.y(), -slope_ / (q * w_rad_));
    image.by_parameters.x() = (z * slope_by_w_ / q - image.scale) / w_rad_;
    return pixelByScale(calibration(), point_C, image, pixel_by_point, pixel_by_parameters);
  }

  std::optional<Vec3> unproject(const Vec2& pixel) const override {
    const Vec2 m = placeOf(calibration(), pixel);
    const double radius = m.norm();
    const double angle_rad = radius * w_rad_;
    if (!(angle_rad < std::numbers::pi)) return std::nullopt;
    if (radius == 0.0) return Vec3::UnitZ();
    const Vec2 lateral = std::sin(angle_rad) / radius * m;
    const Vec3 ray = Vec3(lateral.x(), lateral.y(), slope_ * std::cos(angle_rad)).normalized();
    if (!(ray.z() >= min_cosine_)) return std::nullopt;
    return ray;
  }

  double maxAngle_rad() const override { return kWidestLens_rad; }

 private:
  double w_rad_, slope_;  ///< slope 2 tan(w / 2)
  double slope_by_w_ = 0.0;
  double min_cosine_ = std::cos(kWidestLens_rad);
};

std::string fieldOfViewFault(const std::vector<double>& p) {
  if (p[0] > 0.0 && p[0] < std::numbers::pi) return {};
  return fmt::format("w of the field-of-view model is {} rad; it must lie between 0 and pi", p[0]);
}

}  // namespace

CameraModel fieldOfViewModel() {
  return {
      .name = "field-of-view",
      .distortions = {"fov", "field-of-view", "atan"},
      .aliases = {"fov"},
      .parameters = {"w"},
      .counts = {1},
      .fault = fieldOfViewFault,
      .make = [](const CameraCalibration& c) -> std::shared_ptr<const Camera> {
        return std::make_shared<FieldOfViewCamera>(c);
      },
      .colmap = {{"FOV", 1}},
      .typical = {0.55, {0.92}},
  };
}

}  // namespace lodeline
