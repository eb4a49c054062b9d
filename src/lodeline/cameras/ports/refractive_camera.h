#pragma once

#include <memory>
#include <optional>
#include <string>

#include "lodeline/cameras/ports/port_refraction.h"

namespace lodeline {

/// Derivative of a pixel by the parameters of the port, in the order of DirectionByPort.
using PixelByPort = Eigen::Matrix<double, 2, Eigen::Dynamic>;

/// Camera in a housing that looks through a port into water. The port gives the direction in which light of a
/// point arrives at the lens, and the lens projects that direction as in air. The parameters of the camera
/// are those of the lens. The camera is valid for points beyond the outer face of the port.
class RefractiveCamera final : public Camera {
 public:
  /// `in_air` is the camera of the same calibration without its port.
  RefractiveCamera(const CameraCalibration& calibration, std::shared_ptr<const Camera> in_air);

  std::optional<Vec2> project(const Vec3& point_C, Mat23* pixel_by_point,
                              PixelByParameters* pixel_by_parameters) const override;
  std::optional<Vec3> unproject(const Vec2& pixel) const override;
  std::optional<ViewRay> viewRay(const Vec2& pixel) const override;
  std::optional<Vec2> projectHomogeneous(const Vec3& point_C, double inverse_scale) const override;
  double maxAngle_rad() const override { return max_angle_rad_; }

  /// Pixel of a point and its derivative by the port.
  std::optional<Vec2> projectByPort(const Vec3& point_C, PixelByPort* pixel_by_port) const;

  const Camera& inAir() const { return *in_air_; }

 private:
  std::optional<Vec3> nominalDirection(const Vec3& in_air_C) const;
  double widestAngle_rad() const;

  std::shared_ptr<const Camera> in_air_;
  std::unique_ptr<const PortRefraction> port_;
  double max_angle_rad_ = 0.0;
};

}  // namespace lodeline
