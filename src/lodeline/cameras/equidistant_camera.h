#pragma once

#include <array>

#include "lodeline/cameras/camera.h"

namespace lodeline {

/// Fisheye camera model. The image radius theta_d is a polynomial of the angle theta to the optical axis:
///
///     theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
///
/// Source: J. Kannala, S. Brandt, "A generic camera model and calibration method for conventional,
/// wide-angle, and fish-eye lenses", PAMI 2006, as used by OpenCV's fisheye module and Kalibr. The model is
/// valid beyond 90 degrees while the polynomial increases, at most to the 115 degrees of the widest lenses
/// made.
class EquidistantCamera final : public Camera {
 public:
  /// `coefficients`: k1 to k4.
  explicit EquidistantCamera(const CameraCalibration& calibration);

  std::optional<Vec2> project(const Vec3& point_C, Mat23* pixel_by_point) const override;
  std::optional<Vec3> unproject(const Vec2& pixel) const override;

  /// Largest angle to the optical axis at which the model is valid, rad.
  double maxAngleRad() const { return max_angle_rad_; }

 private:
  double distort(double theta, double* derivative) const;
  double findMaxAngle() const;

  std::array<double, 4> k_{};
  double max_angle_rad_ = 0.0;
  double max_distorted_ = 0.0;
};

}  // namespace lodeline
