#pragma once

#include <memory>
#include <optional>

#include "lodeline/sensors/rig.h"

namespace lodeline {

/// Maps points of the camera frame (z forward, x right, y down; m) to pixels and back. Implementations are
/// immutable and safe to share between threads.
class Camera {
 public:
  explicit Camera(const CameraCalibration& calibration) : calibration_(calibration) {}
  virtual ~Camera() = default;

  /// Pixel of a point, with the derivative (px/m) where asked for. Nothing where the model does not hold:
  /// behind the camera, or beyond the angle at which the distortion stops growing monotonically. The pixel
  /// may lie outside the image.
  virtual std::optional<Vec2> project(const Vec3& point_C, Mat23* pixel_by_point = nullptr) const = 0;

  /// Unit viewing ray of a pixel, exact to 1e-10 rad within the model's range, nothing outside of it.
  virtual std::optional<Vec3> unproject(const Vec2& pixel) const = 0;

  /// Whether a pixel lies in the image, at least `border_px` from its edges.
  bool contains(const Vec2& pixel, double border_px = 0.0) const {
    return pixel.x() >= border_px && pixel.y() >= border_px &&
           pixel.x() <= calibration_.width_px - 1 - border_px &&
           pixel.y() <= calibration_.height_px - 1 - border_px;
  }

  const CameraCalibration& calibration() const { return calibration_; }

 private:
  CameraCalibration calibration_;
};

/// The model that a calibration names. Throws InputError where the parameters make no camera.
std::shared_ptr<const Camera> makeCamera(const CameraCalibration& calibration);

}  // namespace lodeline
