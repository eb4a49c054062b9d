#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/cameras/image_place.h"

namespace lodeline {
namespace {

/// Fisheye camera of an ellipsoid. With d = sqrt(beta (x^2 + y^2) + z^2) the position in the image, in units
/// of the focal lengths, is
///
///     (x, y) / (alpha d + (1 - alpha) z)
///
/// Source: B. Khomutenko, G. Garcia, P. Martinet, "An enhanced unified camera model", RA-L 2016. Model `eucm`
/// of Kalibr and Basalt.
class ExtendedUnifiedCamera final : public Camera {
 public:
  explicit ExtendedUnifiedCamera(const CameraCalibration& calibration)
      : Camera(calibration), alpha_(calibration.distortion.at(0)), beta_(calibration.distortion.at(1)) {
    // The model is injective for z > -w d (Usenko et al. 2018, equation 33).
    const double w = alpha_ <= 0.5 ? alpha_ / (1.0 - alpha_) : (1.0 - alpha_) / alpha_;
    const double end_rad = std::numbers::pi - std::atan2(std::sqrt(1.0 - w * w), w * std::sqrt(beta_));
    max_angle_rad_ = std::min(kWidestLens_rad, end_rad - kMarginToTheEnd_rad);
    min_cosine_ = std::cos(max_angle_rad_);
  }

  std::optional<Vec2> project(const Vec3& point_C, Mat23* pixel_by_point,
                              PixelByParameters* pixel_by_parameters) const override {
    const double z = point_C.z(), distance = point_C.norm();
    if (!(distance > 0.0) || !(z >= min_cosine_ * distance)) return std::nullopt;
    const double rho2 = point_C.head<2>().squaredNorm();
    const double d = std::sqrt(beta_ * rho2 + z * z);
    Vec3 by_point = alpha_ / d * Vec3(beta_ * point_C.x(), beta_ * point_C.y(), z);
    by_point.z() += 1.0 - alpha_;
    const ImageScale image = ImageScale::inverseOf(alpha_ * d + (1.0 - alpha_) * z, by_point,
                                                   Vec2(d - z, 0.5 * alpha_ * rho2 / d));
    return pixelByScale(calibration(), point_C, image, pixel_by_point, pixel_by_parameters);
  }

  std::optional<Vec3> unproject(const Vec2& pixel) const override {
    const Vec2 m = placeOf(calibration(), pixel);
    const double r2 = m.squaredNorm();
    const double root2 = 1.0 - (2.0 * alpha_ - 1.0) * beta_ * r2;
    if (!(root2 >= 0.0)) return std::nullopt;
    const double mz = (1.0 - beta_ * alpha_ * alpha_ * r2) / (alpha_ * std::sqrt(root2) + 1.0 - alpha_);
    const Vec3 ray = Vec3(m.x(), m.y(), mz).normalized();
    if (!(ray.z() >= min_cosine_)) return std::nullopt;
    return ray;
  }

  double maxAngle_rad() const override { return max_angle_rad_; }

 private:
  double alpha_, beta_;
  double max_angle_rad_ = 0.0, min_cosine_ = 0.0;
};

std::string extendedUnifiedFault(const std::vector<double>& p) {
  if (!(p[0] >= 0.0 && p[0] <= 1.0))
    return fmt::format("alpha of the extended-unified model is {}; it must lie between 0 and 1", p[0]);
  if (!(p[1] > 0.0))
    return fmt::format("beta of the extended-unified model is {}; it must be positive", p[1]);
  return {};
}

}  // namespace

CameraModel extendedUnifiedModel() {
  return {
      .name = "extended-unified",
      .projections = {"eucm", "extended-unified"},
      .aliases = {"eucm"},
      .parameters = {"alpha", "beta"},
      .counts = {2},
      .before_focal_lengths = 2,
      .fault = extendedUnifiedFault,
      .make = [](const CameraCalibration& c) -> std::shared_ptr<const Camera> {
        return std::make_shared<ExtendedUnifiedCamera>(c);
      },
      .typical = {0.55, {0.62, 1.08}},
  };
}

}  // namespace lodeline
