#pragma once

#include <array>

#include "lodeline/cameras/camera.h"

namespace lodeline {

/// Pinhole camera with Brown-Conrady distortion, k1 k2 p1 p2 k3 k4 k5 k6 in OpenCV's order (zeros make the
/// ideal pinhole). Formulas: OpenCV, "Camera Calibration and 3D Reconstruction". On the plane z = 1, with r^2
/// = x^2 + y^2,
///
///     x_d = x (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
///
/// and likewise for y_d. Outside the image, a polynomial fitted inside it stops being monotonic, and two rays
/// then share one pixel. The model is therefore valid only within the radius at which this first happens.
class RadialTangentialCamera final : public Camera {
 public:
  /// `coefficients`: up to 8; missing ones are zero.
  explicit RadialTangentialCamera(const CameraCalibration& calibration);

  std::optional<Vec2> project(const Vec3& point_C, Mat23* pixel_by_point) const override;
  std::optional<Vec3> unproject(const Vec2& pixel) const override;

  /// Largest tangent of the angle to the optical axis at which the model is valid.
  double maxRadius() const { return max_radius_; }

 private:
  Vec2 distort(const Vec2& undistorted, Mat2* jacobian) const;
  /// Radial distortion factor at r^2, and its derivative by r^2.
  double radialFactor(double r2, double* derivative) const;
  bool isRegular(double radius) const;
  double findMaxRadius() const;
  double invertRadial(double distorted_radius) const;

  std::array<double, 8> k_{};
  double max_radius_ = 0.0;
};

}  // namespace lodeline
