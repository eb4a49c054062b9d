#include "lodeline/cameras/radial_tangential_camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace lodeline {
namespace {

constexpr double kMaxAngleRad = 89.5 * std::numbers::pi / 180.0;
constexpr double kConvergedStep = 1e-12;
constexpr int kMaxIterations = 50;

}  // namespace

RadialTangentialCamera::RadialTangentialCamera(const CameraCalibration& calibration) : Camera(calibration) {
  std::copy_n(calibration.distortion.begin(), std::min(calibration.distortion.size(), k_.size()), k_.begin());
  max_radius_ = findMaxRadius();
}

double RadialTangentialCamera::radialFactor(double r2, double* derivative) const {
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = k_;
  const double numerator = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double denominator = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
  const double factor = numerator / denominator;
  if (derivative) {
    const double numerator_slope = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);
    const double denominator_slope = k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6);
    *derivative = (numerator_slope - factor * denominator_slope) / denominator;
  }
  return factor;
}

Vec2 RadialTangentialCamera::distort(const Vec2& undistorted, Mat2* jacobian) const {
  const double x = undistorted.x(), y = undistorted.y();
  const double p1 = k_[2], p2 = k_[3];
  const double r2 = x * x + y * y;
  double slope = 0.0;
  const double factor = radialFactor(r2, &slope);
  if (jacobian) {
    const double cross = 2.0 * (x * y * slope + p1 * x + p2 * y);
    *jacobian << factor + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x, cross, cross,
        factor + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x;
  }
  return Vec2(x * factor + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
              y * factor + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y);
}

bool RadialTangentialCamera::isRegular(double radius) const {
  const double r2 = radius * radius;
  double slope = 0.0;
  const double factor = radialFactor(r2, &slope);
  // A negative factor means a point beyond a pole of the rational model.
  if (!(factor > 0.0) || !(factor + 2.0 * r2 * slope > 0.0)) return false;
  if (k_[2] == 0.0 && k_[3] == 0.0) return true;
  // The tangential part depends on the direction only through its sine and cosine, so coarse steps suffice.
  constexpr int kDirections = 36;
  for (int i = 0; i < kDirections; ++i) {
    const double phi = 2.0 * std::numbers::pi * i / kDirections;
    Mat2 jacobian;
    distort(radius * Vec2(std::cos(phi), std::sin(phi)), &jacobian);
    if (!(jacobian.determinant() > 0.0)) return false;
  }
  return true;
}

double RadialTangentialCamera::findMaxRadius() const {
  constexpr int kSteps = 900;
  double good = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    double bad = std::tan(kMaxAngleRad * i / kSteps);
    if (isRegular(bad)) {
      good = bad;
      continue;
    }
    while (bad - good > 1e-12 * (1.0 + bad)) {
      const double middle = 0.5 * (good + bad);
      (isRegular(middle) ? good : bad) = middle;
    }
    break;
  }
  return good;
}

std::optional<Vec2> RadialTangentialCamera::project(const Vec3& point_C, Mat23* pixel_by_point) const {
  if (!(point_C.z() > 0.0)) return std::nullopt;
  const double inverse_z = 1.0 / point_C.z();
  const Vec2 undistorted = point_C.head<2>() * inverse_z;
  if (!(undistorted.squaredNorm() <= max_radius_ * max_radius_)) return std::nullopt;

  Mat2 jacobian;
  const Vec2 distorted = distort(undistorted, pixel_by_point ? &jacobian : nullptr);
  const CameraCalibration& c = calibration();
  if (pixel_by_point) {
    Mat23 undistorted_by_point;
    undistorted_by_point << inverse_z, 0.0, -undistorted.x() * inverse_z, 0.0, inverse_z,
        -undistorted.y() * inverse_z;
    pixel_by_point->noalias() = Vec2(c.fx_px, c.fy_px).asDiagonal() * (jacobian * undistorted_by_point);
  }
  return Vec2(c.fx_px * distorted.x() + c.cx_px, c.fy_px * distorted.y() + c.cy_px);
}

double RadialTangentialCamera::invertRadial(double distorted_radius) const {
  double low = 0.0, high = max_radius_;
  double radius = std::min(distorted_radius, high);
  for (int i = 0; i < kMaxIterations; ++i) {
    double slope = 0.0;
    const double factor = radialFactor(radius * radius, &slope);
    const double error = radius * factor - distorted_radius;
    (error > 0.0 ? high : low) = radius;
    double next = radius - error / (factor + 2.0 * radius * radius * slope);
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    if (std::abs(next - radius) < 1e-9) return next;
    radius = next;
  }
  return radius;
}

std::optional<Vec3> RadialTangentialCamera::unproject(const Vec2& pixel) const {
  const CameraCalibration& c = calibration();
  const Vec2 distorted((pixel.x() - c.cx_px) / c.fx_px, (pixel.y() - c.cy_px) / c.fy_px);
  const double distorted_radius = distorted.norm();
  if (!std::isfinite(distorted_radius)) return std::nullopt;
  if (distorted_radius == 0.0) return Vec3::UnitZ();

  // Inverts the radial part in one dimension with a bracketed iteration. The small tangential part then needs
  // a few Newton steps in two dimensions.
  Vec2 undistorted = distorted * (invertRadial(distorted_radius) / distorted_radius);
  for (int i = 0; i < kMaxIterations; ++i) {
    Mat2 jacobian;
    const Vec2 error = distort(undistorted, &jacobian) - distorted;
    const Vec2 step = -(jacobian.inverse() * error);
    if (!step.allFinite()) return std::nullopt;
    undistorted += step;
    const double radius2 = undistorted.squaredNorm();
    if (step.norm() < kConvergedStep * (1.0 + std::sqrt(radius2))) {
      if (radius2 > max_radius_ * max_radius_) return std::nullopt;
      return Vec3(undistorted.x(), undistorted.y(), 1.0).normalized();
    }
    if (radius2 > max_radius_ * max_radius_) undistorted *= max_radius_ / std::sqrt(radius2);
  }
  return std::nullopt;
}

}  // namespace lodeline
