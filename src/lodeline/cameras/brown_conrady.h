#pragma once

#include <array>
#include <optional>
#include <vector>

#include "lodeline/cameras/camera.h"

namespace lodeline {

/// Distortion of a plane, k1 k2 p1 p2 k3 k4 k5 k6 in OpenCV's order; missing ones are zero. With r^2 = x^2 +
/// y^2
///
///     x_d = x (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
///
/// and likewise for y_d. Formulas: OpenCV, "Camera Calibration and 3D Reconstruction". Outside the image, a
/// polynomial fitted inside it stops being monotonic, and two points then share one image. The distortion is
/// therefore valid only within the radius at which this first happens.
class BrownConrady {
 public:
  /// Takes the coefficients from `first` on. The valid radius is at most the tangent of 89.5 degrees.
  BrownConrady(const std::vector<double>& parameters, size_t first);

  /// Distorted position and, unless null, its derivative.
  Vec2 distort(const Vec2& undistorted, Mat2* jacobian) const {
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

  /// Position whose distorted one is given; nothing outside the valid radius.
  std::optional<Vec2> undistort(const Vec2& distorted) const;

  /// Derivative of the distorted position by all eight coefficients.
  Eigen::Matrix<double, 2, 8> byCoefficients(const Vec2& undistorted) const;

  /// Largest undistorted radius at which the distortion is valid.
  double maxRadius() const { return max_radius_; }

 private:
  /// Radial distortion factor at r^2, and its derivative by r^2.
  double radialFactor(double r2, double* derivative) const {
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
  bool isRegular(double radius) const;
  double findMaxRadius() const;
  double invertRadial(double distorted_radius) const;

  std::array<double, 8> k_{};
  double max_radius_ = 0.0;
};

}  // namespace lodeline
