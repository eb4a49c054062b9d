#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/cameras/image_place.h"

namespace lodeline {
namespace {

/// Fisheye camera of two unit spheres whose centres are xi apart. With d1 = |(x, y, z)|, k = xi d1 + z and d2
/// = |(x, y, k)| the image position, in focal lengths, is
///
///     (x, y) / (alpha d2 + (1 - alpha) k)
///
/// Source: V. Usenko, N. Demmel, D. Cremers, "The double sphere camera model", 3DV 2018. Model `ds` of Kalibr
/// and Basalt.
class DoubleSphereCamera final : public Camera {
 public:
  explicit DoubleSphereCamera(const CameraCalibration& calibration)
      : Camera(calibration), xi_(calibration.distortion.at(0)), alpha_(calibration.distortion.at(1)) {
    // The angle psi on the second sphere ends at cos psi = -w, where the divisor is zero (alpha <= 0.5) or
    // the ray is tangent. There the distance d2 / d1 is `d2` by the law of cosines. The paper's w2 is looser:
    // with alpha = 0 it admits rays beyond the zero of the divisor.
    const double w = alpha_ <= 0.5 ? alpha_ / (1.0 - alpha_) : (1.0 - alpha_) / alpha_;
    const double d2 = std::sqrt(1.0 - xi_ * xi_ * (1.0 - w * w)) - xi_ * w;
    const double end_rad = std::acos(std::clamp(-xi_ - w * d2, -1.0, 1.0));
    max_angle_rad_ = std::min(kWidestLens_rad, end_rad - kMarginToTheEnd_rad);
    min_cosine_ = std::cos(max_angle_rad_);
  }

  std::optional<Vec2> project(const Vec3& point_C, Mat23* pixel_by_point,
                              PixelByParameters* pixel_by_parameters) const override {
    const double z = point_C.z(), d1 = point_C.norm();
    if (!(d1 > 0.0) || !(z >= min_cosine_ * d1)) return std::nullopt;
    const double k = xi_ * d1 + z;
    const double d2 = std::sqrt(point_C.head<2>().squaredNorm() + k * k);
    const double by_k = alpha_ * k / d2 + 1.0 - alpha_;
    Vec3 by_point = by_k * xi_ / d1 * point_C;
    by_point.head<2>() += alpha_ / d2 * point_C.head<2>();
    by_point.z() += by_k;
    const ImageScale image =
        ImageScale::inverseOf(alpha_ * d2 + (1.0 - alpha_) * k, by_point, Vec2(by_k * d1, d2 - k));
    return pixelByScale(calibration(), point_C, image, pixel_by_point, pixel_by_parameters);
  }

  std::optional<Vec3> unproject(const Vec2& pixel) const override {
    const Vec2 m = placeOf(calibration(), pixel);
    const double r2 = m.squaredNorm();
    const double root2 = 1.0 - (2.0 * alpha_ - 1.0) * r2;
    if (!(root2 >= 0.0)) return std::nullopt;
    const double mz = (1.0 - alpha_ * alpha_ * r2) / (alpha_ * std::sqrt(root2) + 1.0 - alpha_);
    const double inner2 = mz * mz + (1.0 - xi_ * xi_) * r2;
    if (!(inner2 >= 0.0)) return std::nullopt;
    const double length = (mz * xi_ + std::sqrt(inner2)) / (mz * mz + r2);
    const Vec3 ray = Vec3(length * m.x(), length * m.y(), length * mz - xi_).normalized();
    if (!(ray.z() >= min_cosine_)) return std::nullopt;
    return ray;
  }

  double maxAngle_rad() const override { return max_angle_rad_; }

 private:
  double xi_, alpha_;
  double max_angle_rad_ = 0.0, min_cosine_ = 0.0;
};

std::string doubleSphereFault(const std::vector<double>& p) {
  if (!(p[0] > -1.0 && p[0] < 1.0))
    return fmt::format("xi of the double-sphere model is {}; it must lie between -1 and 1", p[0]);
  if (!(p[1] >= 0.0 && p[1] <= 1.0))
    return fmt::format("alpha of the double-sphere model is {}; it must lie between 0 and 1", p[1]);
  return {};
}

}  // namespace

CameraModel doubleSphereModel() {
  return {
      .name = "double-sphere",
      .projections = {"ds", "double-sphere"},
      .aliases = {"ds"},
      .parameters = {"xi", "alpha"},
      .counts = {2},
      .before_focal_lengths = 2,
      .fault = doubleSphereFault,
      .make = [](const CameraCalibration& c) -> std::shared_ptr<const Camera> {
        return std::make_shared<DoubleSphereCamera>(c);
      },
      .typical = {0.55, {-0.18, 0.59}},
  };
}

}  // namespace lodeline
